// Marks in the picture: points and handles that can be dragged, and witnesses of what is refuted.
import { number, get, svg, KINDS } from "./controls.js";
import { grip, normalAt } from "./handles.js";
import { plus } from "./algebra.js";
import { same, short } from "./values.js";

const WAYS = { ArrowLeft: [-4, 0, 0], ArrowRight: [4, 0, 0], ArrowUp: [0, -4, 0], ArrowDown: [0, 4, 0], PageUp: [0, 0, 0.02], PageDown: [0, 0, -0.02] };
const PULLS = { ArrowUp: [0, 0, 4], ArrowRight: [0, 0, 4], ArrowDown: [0, 0, -4], ArrowLeft: [0, 0, -4] }; // of handles, in pixels along the normal
const PULLING = "the arrow keys up and down pull and push the surface";
const ARROW = 0.08, TOWARDS = 0.3; // a handle's arrow over the picture's size; how long a normal must look not to point at the eye
const FINGER = 22; // pixels within which a finger finds a mark

// Of a studio { s, $, view, act, go, pointsPath }: `overlay` draws the marks where they are now, `grip` is how a handle
// pulls, `release` lets go of what is held.
export function marksOf({ s, $, view, act, go, pointsPath }) {
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
	return { overlay, grip: gripOf, release: () => { held = null; } };
}
