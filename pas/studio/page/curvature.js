// The legend of colours by curvature, hairs of combs, and the diagram of curvature along a curve.
import { make, svg } from "./controls.js";

const STOPS = 24;
const CONVEX = [0.7, 0.09, 0.17, 0.9], CONCAVE = [0.13, 0.4, 0.67, 0.9];
const mix = (a, b, t) => a.map((x, i) => x + (b[i] - x) * t), MIDDLE = [0.93, 0.93, 0.92];
const color = (x) => `rgb(${(x < 0 ? mix(MIDDLE, CONCAVE, Math.pow(-x, 0.8)) : mix(MIDDLE, CONVEX, Math.pow(x, 0.8))).slice(0, 3).map((v) => Math.round(255 * v)).join()})`;

export function legend(place, mode, range, named) {
	place.hidden = mode !== "mean" && mode !== "gauss";
	if (place.hidden) return;
	const bar = svg("svg", { viewBox: "0 0 12 100", preserveAspectRatio: "none", class: "bar" });
	for (let i = 0; i < STOPS; i++) bar.append(svg("rect", { x: 0, y: (100 * i) / STOPS, width: 12, height: 100 / STOPS + 0.3, fill: color(1 - (2 * (i + 0.5)) / STOPS) }));
	const show = (x) => Number(x.toPrecision(3)), square = mode === "gauss" ? "²" : "";
	place.replaceChildren(make("b", {}, mode === "mean" ? "mean curvature" : "Gauss curvature"), make("div", { class: "scale" }, bar, make("div", { class: "ticks" }, ...[1, 0.5, 0, -0.5, -1].map((t) => make("span", {}, String(show(t * range)))))), make("small", {}, named ? `${show(range)}: curvature${square} of the sharpest neighbour` : `in 1/length${square}`));
}

export function hairLines(scene, counts, { points, tips, curvatures }) {
	const data = [], at = (a, i) => scene.local([a[3 * i], a[3 * i + 1], a[3 * i + 2]]);
	let first = 0;
	for (const n of counts) {
		for (let i = first; i < first + n; i++) {
			const c = curvatures[i] < 0 ? CONCAVE : CONVEX, p = at(points, i), q = at(tips, i);
			if ((i - first) % 4 === 0) data.push(...p, ...c.slice(0, 3), 0.6, ...q, ...c.slice(0, 3), 0.6);
			if (i > first) data.push(...at(tips, i - 1), ...c, ...q, ...c, ...at(points, i - 1), 0.13, 0.19, 0.24, 1, ...p, 0.13, 0.19, 0.24, 1);
		}
		first += n;
	}
	return data;
}

// The curve whose curvature changes most.
export function liveliest({ counts, curvatures }) {
	let first = 0;
	const spread = counts.map((n) => { const k = curvatures.subarray(first, (first += n)); return Math.max(...k) - Math.min(...k); });
	return spread.indexOf(Math.max(...spread));
}

// |k| over the length of one curve; concave parts are drawn in the colour of hollows.
export function diagram({ counts, points, curvatures }, which) {
	const first = counts.slice(0, which).reduce((a, b) => a + b, 0), n = counts[which], x = [0], k = Array.from(curvatures.subarray(first, first + n));
	for (let i = 1; i < n; i++) x.push(x[i - 1] + Math.hypot(...[0, 1, 2].map((j) => points[3 * (first + i) + j] - points[3 * (first + i - 1) + j])));
	const most = Math.max(...k.map(Math.abs)) || 1, W = 280, H = 90, X = (i) => (W * x[i]) / (x[n - 1] || 1), Y = (v) => H - (H * Math.abs(v)) / most;
	const out = svg("svg", { viewBox: `-2 -14 ${W + 4} ${H + 30}`, role: "img", "aria-label": `curvature along the curve, up to ${most.toPrecision(3)}` });
	out.append(svg("path", { d: `M0 ${H}H${W}`, class: "axis" }));
	for (let i = 1; i < n; i++) out.append(svg("path", { d: `M${X(i - 1).toFixed(1)} ${Y(k[i - 1]).toFixed(1)}L${X(i).toFixed(1)} ${Y(k[i]).toFixed(1)}`, class: k[i] < 0 ? "hollow" : "round" }));
	out.append(svg("text", { x: 0, y: -3 }, `|k| up to ${most.toPrecision(3)}`), svg("text", { x: W, y: H + 13, "text-anchor": "end" }, `length ${x[n - 1].toPrecision(3)}`));
	return out;
}
