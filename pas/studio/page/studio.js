// The studio: one document, seen, dragged and proved.  `render({ channel, el })` needs of a channel `send(request)`,
// `receive(listener of head and arrays)` and, where connections come and go, `onstate(listener)`.
import { number, Panel, get, make, put, svg, KINDS } from "./controls.js";
import { grip, normalAt } from "./handles.js";
import { Scene } from "./scene.js";
import { plus } from "./algebra.js";
import { COLORS, View, VIEWS } from "./view.js";
import { diagram, hairLines, legend, liveliest } from "./curvature.js";

const MODES = { shaded: "Shaded", zebra: "Zebra", mean: "Mean curvature", gauss: "Gauss curvature" };
const SIGNS = { proved: "✓", refuted: "✗", undecided: "?", "holds, measured": "≈", "fails, measured": "✗", checking: "…" };
const MEASURES = { sharpness: "sharpness", hollowness: "hollowness", bulge: "bulge", wrong_sign: "wrong sign" };
const GHOST = 300; // milliseconds after which an old picture is shown as a ghost
const options = (names) => names.map((name) => make("option", {}, name));
const WAYS = { ArrowLeft: [-4, 0, 0], ArrowRight: [4, 0, 0], ArrowUp: [0, -4, 0], ArrowDown: [0, 4, 0], PageUp: [0, 0, 0.02], PageDown: [0, 0, -0.02] };
const PULLS = { ArrowUp: [0, 0, 4], ArrowRight: [0, 0, 4], ArrowDown: [0, 0, -4], ArrowLeft: [0, 0, -4] }; // of handles, in pixels along the normal
const PULLING = "the arrow keys up and down pull and push the surface";
const ARROW = 0.08, TOWARDS = 0.3; // a handle's arrow over the picture's size; how long a normal must look not to point at the eye
const PAUSE = 120; // milliseconds of rest after which the verdicts on what the page drew by itself are asked for
const PULL = 0.1; // of the picture's size, by which a handle's slider moves the surface
const FINGER = 22; // pixels within which a finger finds a mark
const far = ([x, y]) => Math.hypot(x - 0.5, y - 0.5);
const PLACES = Array.from({ length: 81 }, (_, i) => [(1 + (i % 9)) / 10, (1 + Math.floor(i / 9)) / 10]).sort((a, b) => far(a) - far(b)); // of the picture, from its middle on
const SAVED = 120; // states that can be undone

const same = (a, b) => JSON.stringify(a) === JSON.stringify(b);
const short = (x) => (x === null || x === undefined ? "none" : String(Math.abs(x) < 5e-4 ? 0 : Number(Number(x).toPrecision(3))));

export function render({ channel, el, start = null, keep = () => {} }) {
	const s = { doc: start, seq: 0, shot: 0, shown: -1, final: null, judged: null, past: [], future: [], before: null, lastProved: null, fair: null, asked: new Map(), scene: null, mode: "shaded", section: null, picked: null, combs: null };
	const $ = {};
	const button = (name, label, act, more = {}) => ($[name] = make("button", { type: "button", onclick: act, ...more }, label));
	const row = (...inside) => make("div", { class: "row" }, ...inside), section = (title, ...inside) => make("section", {}, make("h2", {}, title), ...inside);
	el.classList.add("pas-studio");
	el.replaceChildren(
		($.main = make("main", {},
			($.bar = make("div", { class: "bar", role: "toolbar", "aria-label": "Picture" },
				make("div", { class: "group" }, ...Object.entries(MODES).map(([mode, label]) => button(mode, label, () => setMode(mode), { "aria-pressed": String(mode === "shaded") }))),
				($.views = make("select", { "aria-label": "View", onchange: () => { view.aim(VIEWS[$.views.value]); $.views.selectedIndex = 0; } }, make("option", { value: "" }, "View"), ...options(Object.keys(VIEWS)))),
				make("div", { class: "group" }, button("cut", "Section", () => toggle("cut"), { "aria-pressed": "false" }), button("wire", "Cells", () => toggle("wire"), { "aria-pressed": "false" }), button("combs", "Combs", () => toggle("combs"), { "aria-pressed": "false" })),
			)),
			($.place = make("div", { class: "place" })),
			($.marks = svg("svg", { class: "marks" })),
			($.legend = make("div", { class: "legend", hidden: true })),
			($.cutting = make("div", { class: "cutting", hidden: true },
				($.cutAxis = make("select", { "aria-label": "Section plane across", onchange: () => cutNow() }, ...options(["x", "y", "z"]))),
				($.cutAt = make("input", { type: "range", min: -100, max: 100, value: 0, "aria-label": "Section plane at", oninput: () => cutNow() })))),
			($.message = make("div", { class: "message", role: "status", "aria-live": "polite" }, "starting …")),
		)),
		($.side = make("aside", { "aria-label": "Shape" },
			make("header", {}, ($.title = make("h1", {}, "Studio")), ($.gallery = make("select", { "aria-label": "Starting points", hidden: true, onchange: () => pickStart() }))),
			row(button("undo", "Undo", () => step(s.past, s.future), { title: "Ctrl+Z" }), button("redo", "Redo", () => step(s.future, s.past), { title: "Ctrl+Y" }),
				button("open", "Open …", () => $.file.click()), ($.file = make("input", { type: "file", hidden: true, accept: ".toml,.json", onchange: () => { if ($.file.files[0]) openFile($.file.files[0]); $.file.value = ""; } }))),
			make("section", {}, make("h2", {}, "Proof ", ($.overall = make("span", { class: "overall" }))), ($.unfair = make("div", { class: "warning", role: "alert", hidden: true }, ($.reasons = make("span", {})), button("fairer", "Back to the last fair", () => openDocument(s.fair, false), { class: "small" }))), ($.lamps = make("ul", { class: "lamps" })),
				($.help = make("div", { class: "row", hidden: true }, button("repair", "Repair", () => repair()), button("back", "Back to the last proved", () => back())))),
			($.measured = make("section", { hidden: true }, make("h2", {}, "Fairness ", ($.measuring = make("span", { class: "told" }))), ($.fairness = make("dl", {})))),
			($.curve = make("section", { hidden: true }, make("h2", {}, "Curvature along a curve "), ($.curves = make("select", { "aria-label": "Curve", onchange: () => drawDiagram() })), ($.diagram = make("div", { class: "diagram" })))),
			section("Shape", ($.controls = make("div", {}))),
			section("The same in code", row(button("python", "Copy as Python", () => copy("python")), button("toml", "Copy as TOML", () => copy("toml"))), ($.code = make("pre", { tabindex: 0, "aria-label": "Python" }))),
			section("Save", row(($.format = make("select", { "aria-label": "Format" }, ...options([".pas.json"]))), button("export", "Export", () => exportNow()), button("png", "PNG", () => png()), button("film", "Turntable", () => film(), { title: "one turn as a WebM film" }), ($.pixels = make("select", { "aria-label": "Size of the PNG" }, ...options(["1200 x 900", "1920 x 1080", "3840 x 2160", "600 x 450"]))))),
		)),
	);

	const say = (text, bad = false) => { $.message.textContent = text; $.message.classList.toggle("bad", bad); };
	let view;
	try { view = new View($.place, () => overlay()); } catch (error) { say(error.message, true); return { destroy() {} }; }
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
		span(at, value) { const g = gripOf(at), wide = g ? Math.abs(g.change) * PULL * s.scene.reach : 1; return { low: value - wide, high: value + wide }; },
		addHandle() { say("looking for a handle …"); channel.send({ do: "handle", document: s.doc, at: s.picked ? s.scene.world(s.picked.point) : someSurfacePoint() }); },
	};
	const panel = new Panel($.controls, act);
	const pointsPath = () => (s.doc.kind === "project" ? ["sliders", "points"] : ["problem", "points"]);
	function someSurfacePoint() { const r = $.place.getBoundingClientRect(); for (const [x, y] of PLACES) { const p = view.pick(x * r.width, y * r.height); if (p) return s.scene.world(p.point); } return s.scene.origin; }
	function change(doc, settled) {
		s.doc = doc; s.seq++; stale(); panel.update(doc); buttons(); overlay(); s.asked.set(s.seq, doc);
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
		const before = s.before; s.before = held = null;
		if (before && !same(before, s.doc)) remember(before);
	}
	function step(from, to) { settle(); if (!from.length) return; to.push(s.doc); const doc = from.pop(), name = (d) => [d.kind, d.name, d.problem?.name]; s.fresh = !same(name(doc), name(s.doc)); go(doc); }
	function openDocument(doc, fresh = true) { settle(); if (s.doc && !same(s.doc, doc)) remember(s.doc); s.fresh = fresh; go(doc); }
	const buttons = () => { $.gallery.value = Object.keys(s.starts || {}).find((name) => same(s.starts[name], s.doc)) || ""; $.undo.disabled = !s.past.length; $.redo.disabled = !s.future.length; const done = s.final?.seq === s.seq; $.python.disabled = !done; $.export.disabled = !done || s.writing; $.toml.disabled = !done || !s.final.toml; };
	function ghostLater() { clearTimeout(s.ghost); s.ghost = setTimeout(() => { const old = s.shown !== s.seq; $.place.classList.toggle("ghost", old); if (old) say("solving …"); }, GHOST); }

	// ---- lamps
	function stale() {
		$.overall.textContent = "checking"; $.overall.className = "overall checking"; $.help.hidden = true; settled();
		for (const l of $.lamps.children) { l.className = "checking"; l.firstChild.replaceChildren(SIGNS.checking, make("span", { class: "unseen" }, " checking ")); }
	}
	function judge(head) {
		s.judged = head;
		$.lamps.replaceChildren(...[...head.verdicts].sort((a, b) => (a.status === "proved") - (b.status === "proved")).map((v) => {
			const state = v.status.split(",")[0], l = make("li", { class: v.status === "holds, measured" ? "measured" : state, title: v.reason }, make("b", {}, SIGNS[v.status] || "?", make("span", { class: v.status === "proved" ? "unseen" : "" }, ` ${v.status} `)), make("span", {}, v.claim));
			if (v.witness) l.append(make("button", { type: "button", class: "small", onclick: () => { const p = s.scene.local(v.witness); view.aim(p.some((x) => Math.abs(x) > 1e-9) ? p : [1, -1, 1]); say(`${v.claim}: ${v.reason}`); } }, "Show"));
			return l;
		}));
		const bad = head.verdicts.some((v) => v.status === "refuted"), word = head.proved ? "all proved" : bad ? "refuted" : head.counts;
		$.overall.textContent = `${head.proved ? SIGNS.proved : bad ? SIGNS.refuted : SIGNS.undecided} ${word}`;
		$.overall.className = `overall ${head.proved ? "proved" : bad ? "refuted" : "undecided"}`;
		$.help.hidden = !bad; $.back.disabled = !s.lastProved;
		settled(); overlay();
	}
	// How fair is what is seen: said as long as it is seen, and "being measured" once another picture is.
	function measures({ shot, facts, unfair = [] }) {
		if (shot !== s.shot) return;
		const f = facts.fairness, limits = facts.limits || {};
		s.measured = shot; s.unfair = unfair; s.known = Boolean(f); settled();
		$.measured.hidden = !f; if (!f) return;
		$.fairness.replaceChildren(...Object.entries(MEASURES).flatMap(([key, label]) => {
			const value = f[key], most = limits[key], high = most !== undefined && value > most;
			const none = key === "hollowness" && !f.arc;
			return [make("dt", {}, label), make("dd", { class: high ? "high" : "" }, none ? "none" : `${short(value)}${most === undefined || most > 100 ? "" : ` / ${short(most)}`}${high ? " ▲" : ""}`)];
		}));
	}

	// Takes what is proved and fair for the last such state: its values are marked on the sliders that have left it.
	function settled() {
		const now = s.measured === s.shot, doc = s.asked.get(s.shown);
		if (now && s.known && !s.unfair.length && s.judged?.proved && s.judged.shot === s.shot) s.fair = doc;
		s.beyond = now && s.unfair.length > 0;
		const said = s.beyond ? "undecided" : now && s.shown === s.seq ? "proved" : "checking"; // what is fair is said of the newest state alone
		$.fairness.classList.toggle("old", said === "checking"); $.measuring.textContent = { undecided: "▲ not fair", proved: s.known ? "✓ fair" : "", checking: "being measured …" }[said]; $.measuring.className = `told ${said}`;
		$.unfair.hidden = !s.beyond; $.reasons.textContent = s.beyond ? `▲ not fair: ${s.unfair.join("; ")} ` : ""; $.fairer.hidden = !s.fair || same(s.fair, doc);
		marked();
	}
	function marked() { panel.warn(s.fair && (s.beyond || s.judged?.verdicts.some((v) => v.status === "refuted")) ? s.fair : null, s.doc); }

	// ---- what comes from the other side
	function receive(head, arrays) {
		({ picture, moved, outline, verdicts: judged, measures, mesh: meshed, refused, document: opened, gallery, file, combs: combed, changed, safe: (h) => panel.mark(h.limits) }[head.kind] || (() => {}))(head, arrays);
	}
	function picture(head, arrays) {
		if (head.seq < s.shown || (head.seq === s.shown && s.final?.seq === head.seq)) return;
		const keepView = s.scene !== null && !s.fresh; s.fresh = false; if (!keepView) s.picked = null;
		s.scene = new Scene(head, arrays); s.sceneName = head.scene || ""; view.load(s.scene, keepView);
		s.unit = head.unit; lookAgain(); wireNow(); arrived(head);
		if (head.final) {
			s.final = head; $.title.textContent = head.name; panel.show(head.controls, s.doc, head.members);
			$.code.textContent = head.python; formats(head.formats);
			if (head.seq === s.seq) {
				s.solved = s.doc; judge(head); if (head.proved) s.lastProved = s.doc;
				say(`${head.how === "cast" ? `degree ${head.degree}, ${head.title}` : `${head.triangles} triangles`}: ${head.proved ? "all proved" : head.counts}`);
			}
			buttons(); if (pressed("combs")) askCombs(); if (view.tooSlow) view.onslow();
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
	function pickStart() { openDocument(s.starts[$.gallery.value]); }
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
	const pressed = (name) => $[name].getAttribute("aria-pressed") === "true";
	function toggle(name) { $[name].setAttribute("aria-pressed", String(!pressed(name))); ({ cut: cutNow, wire: wireNow, combs: combsNow })[name](); }
	function setMode(mode) { s.mode = mode; for (const m of Object.keys(MODES)) $[m].setAttribute("aria-pressed", String(m === mode)); lookAgain(); }
	function lookAgain() {
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

	// ---- marks in the picture: points and handles that can be dragged, and witnesses
	const marks = new Map(), pulled = (kind) => kind === "through" && s.scene.tetrahedra;
	const gripOf = (at) => { const known = (s.solved && get(s.solved, [...pointsPath(), "handles"])) || []; return s.scene?.tetrahedra ? grip(s.scene, at, s.final?.shares[known.findIndex(([other]) => same(other, at))]) : null; };
	function overlay() {
		if (!s.scene || !s.doc) return;
		const wanted = new Map(), points = s.doc.kind === "teapot" ? {} : get(s.doc, pointsPath()) || {};
		for (const kind of KINDS) (points[kind] || []).forEach((p, i) => {
			const at = s.scene.local(p.map(number)), keys = pulled(kind) ? PULLING : "the arrow keys move it";
			wanted.set(`${kind} ${i}`, { kind, p: at, way: pulled(kind) ? normalAt(s.scene, at) : null, text: `${kind} ${i + 1}`, about: `${p.map((x) => short(number(x))).join(", ")}; ${keys}`, take: () => takePoint(kind, i) });
		});
		(points.handles || []).forEach(([at, value], i) => {
			const g = gripOf(at);
			if (g) wanted.set(`handle ${i}`, { kind: "handle", p: g.place, way: g.normal, text: `handle ${i + 1}`, about: `${short(number(value))}; ${PULLING}`, take: () => takeHandle(at, i) });
		});
		if (s.judged && s.shown === s.seq && !$.overall.classList.contains("checking")) s.judged.verdicts.forEach((v, i) => { if (v.witness && v.status === "refuted") wanted.set(`witness ${i}`, { kind: "witness", p: s.scene.local(v.witness), text: `${v.claim} fails here`, about: v.witness.map(short).join(", ") }); });
		for (const [key, g] of marks) if (!wanted.has(key)) { if (held?.g === g) { held = null; queueMicrotask(act.commit); } g.remove(); marks.delete(key); }
		for (const [key, m] of wanted) {
			let g = marks.get(key);
			if (!g) {
				g = svg("g", { class: `mark ${m.kind}` }); g.append(svg("circle", { r: 7 }), svg("path", { d: "M-11 0H11M0-11V11" }), svg("text", { x: 12, y: -9 }));
				if (m.take) { g.setAttribute("tabindex", 0); g.setAttribute("role", "button"); draggable(g); }
				marks.set(key, g); $.marks.append(g);
			}
			g.take = m.take; g.pulls = Boolean(m.way);
			const [x, y] = view.toScreen(m.p);
			g.at = [x, y]; g.setAttribute("transform", `translate(${x.toFixed(1)} ${y.toFixed(1)})`); g.lastChild.textContent = m.text; g.setAttribute("aria-label", `${m.text}: ${m.about}`);
			if (m.way) { const [u, v] = view.toScreen(plus(m.p, m.way, ARROW * s.scene.reach)); g.childNodes[1].setAttribute("d", `M0 0L${(u - x).toFixed(1)} ${(v - y).toFixed(1)}`); }
		}
	}
	// What is taken by the pointer or by keys: how it follows a shift on the screen, and further in depth or along the
	// normal.  What pulls the surface goes along its normal, unless it is let `free`.
	function along(place, normal) {
		const [x, y] = view.toScreen(place), [u, v] = view.toScreen(plus(place, normal)), one = view.place.clientHeight / (2 * view.camera.wide);
		const way = Math.hypot(u - x, v - y) > one * TOWARDS ? [u - x, v - y] : [0, -one], square = way[0] ** 2 + way[1] ** 2; // where it points at the eye, up pulls
		return (dx, dy, pulled) => (dx * way[0] + dy * way[1]) / square + pulled / one;
	}
	function takePoint(kind, i) {
		const path = [...pointsPath(), kind, i], place = s.scene.local(get(s.doc, path).map(number)), [x, y, deep] = view.toScreen(place);
		const to = (p, digits) => act.move(path, s.scene.world(p).map((c) => String(Number(c.toFixed(digits))))), normal = pulled(kind) && normalAt(s.scene, place), far = normal && along(place, normal);
		return (dx, dy, more, free) => (normal && !free ? to(plus(place, normal, far(dx, dy, more)), 7) : to(view.fromScreen(x + dx, y + dy, deep + more), 4));
	}
	function takeHandle(at, i) {
		const { place, normal, change } = gripOf(at), far = along(place, normal), path = [...pointsPath(), "handles", i, 1], from = number(get(s.doc, path));
		return (dx, dy, more) => act.move(path, String(Number((from + change * far(dx, dy, more)).toPrecision(7))));
	}
	let held = null; // the mark that is dragged, where that began, the last event of its pointer, and how it follows
	function grab(g, e) { e.preventDefault(); g.focus({ preventScroll: true }); g.setPointerCapture(e.pointerId); held = { g, start: [e.clientX, e.clientY], last: e, follow: g.take() }; }
	function drop() { const before = s.before; s.before = held = null; if (before && !same(before, s.doc)) go(before); }
	view.onfinger = (e, [x, y]) => { // what a finger that comes down takes hold of: the nearest mark in reach; with a second one both turn to the picture
		if (held) { const { last } = held; drop(); view.take(last, true); }
		if (view.pointers.size) return false;
		const far = (g) => Math.hypot(g.at[0] - x, g.at[1] - y), near = [...marks.values()].filter((g) => g.take).sort((a, b) => far(a) - far(b))[0];
		if (!near || far(near) > FINGER) return false;
		grab(near, e); return true;
	};
	function draggable(g) {
		g.addEventListener("pointerdown", (e) => { if (e.pointerType === "touch") view.take(e); else grab(g, e); });
		g.addEventListener("pointermove", (e) => { if (held?.last.pointerId !== e.pointerId) return; held.last = e; held.follow(e.clientX - held.start[0], e.clientY - held.start[1], 0, e.shiftKey); });
		const end = (e) => { if (held?.last.pointerId === e.pointerId) { held = null; act.commit(); } };
		g.addEventListener("pointerup", end); g.addEventListener("pointercancel", end);
		g.addEventListener("keydown", (e) => {
			const way = (g.pulls && !e.shiftKey ? PULLS : WAYS)[e.key];
			if (!way) return;
			e.preventDefault(); g.take()(...way, e.shiftKey);
			clearTimeout(s.keyed); s.keyed = setTimeout(() => act.commit(), 500);
		});
	}

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
