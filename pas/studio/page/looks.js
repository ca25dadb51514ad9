// How the picture looks: its colours, a section, the cells' edges, and curvature combs with their diagram.
import { make } from "./controls.js";
import { diagram, hairLines, legend, liveliest } from "./curvature.js";

export const MODES = { shaded: "Shaded", zebra: "Zebra", mean: "Mean curvature", gauss: "Gauss curvature" };

// Of a studio { s, $, view, channel }: `set` takes a mode, `toggle` a button's name, `again` shows what is chosen.
export function looksOf({ s, $, view, channel }) {
	const pressed = (name) => $[name].getAttribute("aria-pressed") === "true";
	function toggle(name) { $[name].setAttribute("aria-pressed", String(!pressed(name))); ({ cut: cutNow, wire: wireNow, combs: combsNow })[name](); }
	function set(mode) { s.mode = mode; for (const m of Object.keys(MODES)) $[m].setAttribute("aria-pressed", String(m === mode)); again(); }
	function again() {
		if (!s.scene) return;
		const power = s.mode === "gauss" ? 2 : 1, local = s.scene.how === "cast" ? s.scene.scale : 1, unit = s.unit || 1;
		view.look.mode = s.mode; view.look.range = (unit * local) ** power; view.ask();
		legend($.legend, s.mode, unit ** power, Boolean(s.unit) && s.scene.how === "cast");
	}
	function cutNow() {
		const on = pressed("cut"), axis = $.cutAxis.selectedIndex, plane = [0, 0, 0, 0];
		$.cutting.hidden = !on; plane[axis] = axis === 1 ? 1 : -1; plane[3] = (-plane[axis] * Number($.cutAt.value) * view.caster.reach) / 100;
		view.look.section = on ? plane : null; view.ask();
	}
	function wireNow() { view.look.wire = pressed("wire"); view.setLines("wire", pressed("wire") && s.scene ? s.scene.edges.flatMap((e) => e.flatMap((p) => [...p, 0.25, 0.35, 0.5, 0.7])) : null, 0); }
	function combsNow() { if (pressed("combs")) askCombs(); else { view.setLines("combs", null); $.curve.hidden = true; } }
	function askCombs() { if (s.final?.seq === s.seq) channel.send({ do: "combs", seq: s.seq, document: s.doc }); }
	function combed(head, arrays) {
		if (head.seq !== s.seq || !pressed("combs")) return;
		s.combs = { counts: head.counts, ...arrays }; view.setLines("combs", hairLines(s.scene, head.counts, arrays), 1e-4);
		$.curve.hidden = !head.counts.length; $.curves.replaceChildren(...head.counts.map((_, i) => make("option", { value: i }, `curve ${i + 1}`))); $.curves.value = liveliest(s.combs); drawDiagram();
	}
	function drawDiagram() { $.diagram.replaceChildren(diagram(s.combs, Number($.curves.value) || 0)); }
	const section = cutNow, wire = wireNow, combs = () => { if (pressed("combs")) askCombs(); };
	return { set, toggle, again, section, wire, combs, combed, drawDiagram };
}
