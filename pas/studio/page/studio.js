// The studio: one document, seen, dragged and proved.  `render({ channel, el })` needs of a channel `send(request)`,
// `receive(listener of head and arrays)` and, where connections come and go, `onstate(listener)`.
import { number, Panel, get, make, put } from "./controls.js";
import { elements, options } from "./elements.js";
import { looksOf } from "./looks.js";
import { marksOf } from "./marks.js";
import { Scene } from "./scene.js";
import { same, short } from "./values.js";
import { verdictsOf } from "./verdicts.js";
import { COLORS, View, VIEWS } from "./view.js";

const GHOST = 300; // milliseconds after which an old picture is shown as a ghost
const PAUSE = 120; // milliseconds of rest after which the verdicts on what the page drew by itself are asked for
const PULL = 0.1; // of the picture's size, by which a handle's slider moves the surface
const far = ([x, y]) => Math.hypot(x - 0.5, y - 0.5);
const PLACES = Array.from({ length: 81 }, (_, i) => [(1 + (i % 9)) / 10, (1 + Math.floor(i / 9)) / 10]).sort((a, b) => far(a) - far(b)); // of the picture, from its middle on
const SAVED = 120; // states that can be undone

export function render({ channel, el, start = null, keep = () => {} }) {
	const s = { doc: start, seq: 0, shot: 0, shown: -1, final: null, judged: null, past: [], future: [], before: null, lastProved: null, fair: null, asked: new Map(), scene: null, mode: "shaded", section: null, picked: null, combs: null };
	const $ = elements(el, {
		mode: (mode) => looks.set(mode), view: (name) => view.aim(VIEWS[name]), toggle: (name) => looks.toggle(name), section: () => looks.section(), curve: () => looks.drawDiagram(),
		start: (name) => openDocument(s.starts[name]), undo: () => step(s.past, s.future), redo: () => step(s.future, s.past), file: (f) => openFile(f),
		fairer: () => openDocument(s.fair, false), repair, back, copy, export: exportNow, png, film,
	});

	const say = (text, bad = false) => { $.message.textContent = text; $.message.classList.toggle("bad", bad); };
	let view, marks = null;
	try { view = new View($.place, () => marks?.overlay()); } catch (error) { say(error.message, true); return { destroy() {} }; }
	view.onslow = () => { if (s.final?.seq !== s.seq || s.scene.how !== "cast" || s.meshing === s.seq) return; s.meshing = s.seq; channel.send({ do: "mesh", seq: s.seq, document: s.doc }); };
	view.onpick = (x, y) => { const p = view.pick(x, y); s.picked = p; if (p) say(`at ${s.scene.world(p.point).map(short).join(", ")}: mean curvature ${short(p.mean / s.scene.scale)}, Gauss curvature ${short(p.gauss / s.scene.scale ** 2)}`); };

	// ---- the document
	const act = {
		document: () => s.doc,
		wrong: (text) => say(text, true),
		move(path, value, settled = false, first = (doc) => doc) { if (!s.before) s.before = s.doc; change(put(first(s.doc), path, value), settled); },
		commit() { const before = s.before; s.before = null; if (before) { if (!same(before, s.doc)) remember(before); rest(); } },
		room: () => { const r = s.scene ? s.scene.reach * s.scene.scale : 2; return { low: -r, high: r }; },
		addPoint(kind, digits = 3) {
			const path = pointsPath(), held = get(s.doc, [...path, kind]) || [], p = s.picked ? s.scene.world(s.picked.point) : someSurfacePoint();
			act.move([...path, kind], [...held, p.map((x) => String(Number(x.toFixed(digits))))], true); act.commit();
		},
		atDegree: (doc) => (doc.kind === "problem" && !Number.isInteger(doc.problem.degree) && s.scene ? put(doc, ["problem", "degree"], s.scene.head.degree) : doc),
		span(at, value) { const g = marks.grip(at), wide = g ? Math.abs(g.change) * PULL * s.scene.reach : 1; return { low: value - wide, high: value + wide }; },
		addHandle() { say("looking for a handle …"); channel.send({ do: "handle", document: s.doc, at: s.picked ? s.scene.world(s.picked.point) : someSurfacePoint() }); },
	};
	const panel = new Panel($.controls, act);
	const pointsPath = () => (s.doc.kind === "project" ? ["sliders", "points"] : ["problem", "points"]);
	const verdicts = verdictsOf({ s, $, view, panel, say, overlay: () => marks.overlay() }), { stale, judge, settled } = verdicts;
	const looks = looksOf({ s, $, view, channel });
	marks = marksOf({ s, $, view, act, go, pointsPath });
	function someSurfacePoint() { const r = $.place.getBoundingClientRect(); for (const [x, y] of PLACES) { const p = view.pick(x * r.width, y * r.height); if (p) return s.scene.world(p.point); } return s.scene.origin; }
	function change(doc, settled) {
		s.doc = doc; s.seq++; stale(); panel.update(doc); buttons(); marks.overlay(); s.asked.set(s.seq, doc);
		const move = () => channel.send({ do: "move", seq: s.seq, document: doc, scene: s.sceneName || "", mesh: view.tooSlow && s.scene?.how === "cast" });
		clearTimeout(s.asking);
		if (!settled && drawnHere(doc)) s.asking = setTimeout(move, PAUSE); else if (!settled) move();
		ghostLater();
	}
	// Whether the page could draw by itself what has changed: of blends by a generatrix, their shape values.
	function drawnHere(doc) {
		const usual = s.scene?.head.legs?.values, shape = doc.problem?.shape;
		if (!usual || !shape || !same(bare(doc, usual), bare(s.solved, usual))) return false;
		const values = Object.keys(usual).filter((name) => name in shape).map((name) => [name, number(shape[name])]);
		if (!s.scene.generated(Object.fromEntries(values))) return false;
		view.caster.setMeshes(s.scene.meshes); view.ask(); s.shot = 0; s.shown = s.seq; settled(); s.came = performance.now(); say("moving …");
		return true;
	}
	const bare = (doc, names) => Object.keys(names).reduce((d, name) => put(d, ["problem", "shape", name], undefined), doc);
	function rest() { clearTimeout(s.asking); s.asked.set(s.seq, s.doc); channel.send({ do: "rest", seq: s.seq, document: s.doc }); keep(s.doc); buttons(); ghostLater(); }
	function remember(doc) { s.past.push(doc); if (s.past.length > SAVED) s.past.shift(); s.future.length = 0; }
	function go(doc) { s.doc = doc; s.seq++; stale(); panel.update(doc); rest(); }
	function settle() { // ends what is dragged or held by a key, as a state of its own, before the document is replaced
		clearTimeout(s.keyed);
		const before = s.before; s.before = null; marks.release();
		if (before && !same(before, s.doc)) remember(before);
	}
	function step(from, to) { settle(); if (!from.length) return; to.push(s.doc); const doc = from.pop(), name = (d) => [d.kind, d.name, d.problem?.name]; s.fresh = !same(name(doc), name(s.doc)); go(doc); }
	function openDocument(doc, fresh = true) { settle(); if (s.doc && !same(s.doc, doc)) remember(s.doc); s.fresh = fresh; go(doc); }
	const buttons = () => { $.gallery.value = Object.keys(s.starts || {}).find((name) => same(s.starts[name], s.doc)) || ""; $.undo.disabled = !s.past.length; $.redo.disabled = !s.future.length; const done = s.final?.seq === s.seq; $.python.disabled = !done; $.export.disabled = !done || s.writing; $.toml.disabled = !done || !s.final.toml; };
	function ghostLater() { clearTimeout(s.ghost); s.ghost = setTimeout(() => { const old = s.shown !== s.seq; $.place.classList.toggle("ghost", old); if (old) say("solving …"); }, GHOST); }

	// ---- what comes from the other side
	function receive(head, arrays) {
		({ picture, moved, outline, verdicts: judged, measures: verdicts.measures, mesh: meshed, refused, document: opened, gallery, file, combs: looks.combed, changed, safe: (h) => panel.mark(h.limits) }[head.kind] || (() => {}))(head, arrays);
	}
	function picture(head, arrays) {
		if (head.seq < s.shown || (head.seq === s.shown && s.final?.seq === head.seq)) return;
		const keepView = s.scene !== null && !s.fresh; s.fresh = false; if (!keepView) s.picked = null;
		s.scene = new Scene(head, arrays); s.sceneName = head.scene || ""; view.load(s.scene, keepView);
		s.unit = head.unit; looks.again(); looks.wire(); arrived(head);
		if (head.final) {
			$.parts.replaceChildren(...(head.parts || []).map(([name, color]) => { const l = make("li", {}, name); l.style.borderColor = color; return l; }));
			s.final = head; $.title.textContent = head.name; panel.show(head.controls, s.doc, head.members);
			$.code.textContent = head.python; formats(head.formats);
			if (head.seq === s.seq) {
				s.solved = s.doc; judge(head); if (head.proved) s.lastProved = s.doc;
				say(`${head.how === "cast" ? `degree ${head.degree}, ${head.title}` : `${head.triangles} triangles`}: ${head.proved ? "all proved" : head.counts}`);
			}
			buttons(); looks.combs(); if (view.tooSlow) view.onslow();
			if (head.controls.some((c) => c.safe)) channel.send({ do: "safe", seq: head.seq, document: s.doc });
		}
	}
	function formats(names) { const chosen = $.format.value; $.format.replaceChildren(...options(names)); if (names.includes(chosen)) $.format.value = chosen; }
	function moved(head, arrays) {
		if (head.seq < s.shown || !s.scene) return;
		if (s.scene.how === "cast") { if (head.scene !== s.sceneName) return; s.scene.moved(arrays.coefficients, head.exponent); view.caster.change(s.scene.polynomials); }
		else { s.scene.movedMesh(arrays); view.caster.setMeshes(s.scene.meshes); }
		arrived(head); meshed(head, arrays); view.ask();
	}
	function meshed(head, arrays) { // in place of rays, while anything moves, where these are too slow
		if (!arrays["points 0"] || head.seq !== s.shown || s.scene?.how !== "cast") return;
		view.caster.setSubstitute(s.scene.substitute(arrays, COLORS.surface.outside)); view.ask();
	}
	function outline(head, arrays) { if (head.seq >= s.shown && s.scene?.how === "cast" && s.scene.outlined(head, arrays)) { s.sceneName = ""; s.scene.load(view.caster); view.ask(); } }
	function arrived(head) {
		s.shot = head.shot; s.shown = head.seq; s.came = performance.now(); s.spent = head.spent || 0; settled();
		for (const seq of s.asked.keys()) if (seq < s.shown) s.asked.delete(seq);
		if (head.seq === s.seq) { clearTimeout(s.ghost); $.place.classList.remove("ghost"); if (!head.final) say("moving …"); }
	}
	function judged(head) { if (head.shot !== s.shot || s.shown !== s.seq) return; judge(head); say(`seen now: ${head.proved ? "all proved" : head.counts}`); }
	function refused(head) {
		if (head.of === "mesh" || head.of === "safe") return; // which nobody asked for but the page, and which it can do without
		say(head.text, true); $.repair.disabled = false; if (head.of === "export") written();
		if (head.seq && head.seq === s.seq && (head.of === "move" || head.of === "rest")) { clearTimeout(s.ghost); $.place.classList.add("ghost"); $.overall.textContent = "no surface for this state; the last one is shown"; $.overall.className = "overall undecided"; $.lamps.replaceChildren(); $.help.hidden = false; $.back.disabled = !s.lastProved; }
	}
	function opened(head) {
		if (head.kept && s.doc) { go(s.doc); return; }
		$.gallery.hidden = true; openDocument(head.document, !s.scene || s.doc?.kind !== head.document.kind); if (head.file) say(`${head.file} was read`);
	}
	function gallery(head) {
		s.starts = head.documents; $.gallery.hidden = false;
		$.gallery.replaceChildren(make("option", { value: "", disabled: true }, "Starting points"), ...options(Object.keys(head.documents)));
		if (!s.doc) openDocument(Object.values(head.documents)[0]); else go(s.doc);
	}
	function file(head, arrays) {
		written();
		const name = head.proved ? head.name : head.name.replace(/^([^.]*)/, "$1-not-proved");
		download(new Blob([arrays.content]), name); say(head.proved ? `${name} was saved` : `${name} was saved; its shape is not proved`);
	}
	function changed(head) { $.repair.disabled = false; openDocument(head.document, false); }

	// ---- buttons
	function repair() { $.repair.disabled = true; say("looking for a shape near this one that is proved …"); channel.send({ do: "repair", document: s.doc }); }
	function back() { if (s.lastProved) openDocument(s.lastProved, false); }
	function written() { s.writing = false; buttons(); }
	function exportNow() { s.writing = true; buttons(); say("writing …"); channel.send({ do: "export", document: s.doc, format: $.format.value }); }
	const paper = () => getComputedStyle($.code).backgroundColor; // as it came out: a canvas takes no formula for light and dark
	async function png() { const [w, h] = $.pixels.value.split(" x ").map(Number); download(await view.png(w, h, paper()), `${$.title.textContent || "shape"}.png`); }
	async function film() {
		if (!globalThis.MediaRecorder) { say("this browser cannot record films", true); return; }
		$.film.disabled = true; say("one turn is recorded …");
		download(await view.film(paper()), `${$.title.textContent || "shape"}.webm`);
		$.film.disabled = false; say("the turn was saved");
	}
	async function copy(kind) {
		const text = s.final[kind]; $.code.textContent = text;
		try { await navigator.clipboard.writeText(text); say(`copied as ${kind === "python" ? "Python" : "TOML"}`); } catch { getSelection().selectAllChildren($.code); say("select and copy the text; this browser does not let a page do it", true); }
	}
	function download(blob, name) { s.downloaded = { blob, name }; const a = make("a", { href: URL.createObjectURL(blob), download: name }); a.click(); setTimeout(() => URL.revokeObjectURL(a.href), 10000); }
	async function openFile(f) { if (f.size > 4e6) say(`${f.name} is larger than 4 MB`, true); else channel.send({ do: "read", name: f.name, text: await f.text() }); }

	// ---- keys, files dropped, connections
	const onkey = (e) => {
		if (!(e.ctrlKey || e.metaKey) || /^(text|number)$/.test(e.target.type || "")) return;
		const key = e.key.toLowerCase();
		if (key === "z" && !e.shiftKey) { step(s.past, s.future); e.preventDefault(); } else if (key === "y" || key === "z") { step(s.future, s.past); e.preventDefault(); }
	};
	const keys = el.parentNode === document.body ? document : el; // in a notebook other cells have keys of their own
	keys.addEventListener("keydown", onkey);
	el.addEventListener("dragover", (e) => e.preventDefault());
	el.addEventListener("drop", (e) => { e.preventDefault(); const f = e.dataTransfer?.files[0]; if (f) openFile(f); });
	channel.receive(receive);
	channel.onstate?.((text, again) => { written(); say(text, !again); });
	buttons();
	return { state: s, view, panel, act, openDocument, go, destroy() { keys.removeEventListener("keydown", onkey); clearTimeout(s.ghost); view.destroy(); } };
}
