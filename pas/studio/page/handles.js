// Handles pull the surface along its normal.  A B-coefficient is shown where the surface is on the ray from the centre
// through its domain point; pulled by d there, it changes by -|grad f| d over its share in the function: so the surface
// follows the pointer, to first order.
import { dot, exponents, plus, size, times } from "./algebra.js";

const STEPS = 96, HALVINGS = 40; // of a ray, on which the zero next to a domain point is looked for
const FAINT = 1e-3; // share in the function, below which a handle would only jump

const lists = new Map();
function powers(n) { if (!lists.has(n)) lists.set(n, exponents(n)); return lists.get(n); }

export function jet({ degree, values }, [x, y, z]) { // value and gradient
	let f = 0;
	const g = [0, 0, 0];
	powers(degree).forEach(([a, b, c], i) => {
		const v = values[i], X = x ** a, Y = y ** b, Z = z ** c;
		f += v * X * Y * Z;
		if (a) g[0] += v * a * x ** (a - 1) * Y * Z;
		if (b) g[1] += v * b * X * y ** (b - 1) * Z;
		if (c) g[2] += v * c * X * Y * z ** (c - 1);
	});
	return { f, g };
}

function onSurface(polynomial, point, reach) { // the zero next to a point on its ray from the centre, or the point
	const far = size(point), most = far > 1e-9 ? Math.max(1, reach / far) : 1, value = (t) => jet(polynomial, times(point, t)).f;
	let best = null, low = 0, below = value(0) < 0;
	for (let i = 1; i <= STEPS; i++) {
		const high = (most * i) / STEPS, now = value(high) < 0;
		if (now !== below && (best === null || Math.abs(high - 1) < Math.abs(best[1] - 1))) best = [low, high, below];
		low = high; below = now;
	}
	if (best === null) return point;
	let [a, b] = best;
	for (let i = 0; i < HALVINGS; i++) { const m = (a + b) / 2; if (value(m) < 0 === best[2]) a = m; else b = m; }
	return times(point, (a + b) / 2);
}

const factorial = (n) => (n < 2 ? 1 : n * factorial(n - 1));

// The normal of the surface next to a place.
export function normalAt(scene, place) {
	const depth = (b) => Math.min(...b.planes.map((q) => dot(q, place) + q[3])), around = scene.tetrahedra.reduce((a, b) => (depth(b) > depth(a) ? b : a));
	const { g } = jet(scene.surface[around.number], place);
	return times(g, 1 / (size(g) || 1));
}

// Where a B-coefficient takes hold of the surface, the normal there, and how much of it moves the surface by one along
// that, where `share` is how much the function changes there with it (else that of its Bernstein polynomial alone; of the
// function itself, which is that of the scene times 2^exponent); null
// for a cell that there is not.
export function grip(scene, [cell, index], share) {
	const body = scene.tetrahedra?.[cell], degree = index.reduce((a, b) => a + b, 0);
	if (!body || degree !== scene.head.degree) return null;
	const corners = scene.cells[cell].map((v) => scene.vertices[v]), point = corners.reduce((p, v, k) => plus(p, v, index[k] / degree), [0, 0, 0]);
	const polynomial = scene.surface[body.number], place = onSurface(polynomial, point, scene.reach), { g } = jet(polynomial, place), slope = size(g) || 1;
	const alone = body.planes.reduce((w, q, k) => (w * Math.max(0, dot(q, place) + q[3]) ** index[k]) / factorial(index[k]), factorial(degree)), found = share ?? alone;
	return { place, normal: times(g, 1 / slope), change: (-slope * 2 ** scene.exponent) / (Math.sign(found) * Math.max(FAINT, Math.abs(found)) || FAINT) };
}
