// Blends by a generatrix, drawn by the page itself while their shape values are dragged: a Bezier segment for each s,
// whose inner control points are C + l (sqrt(1 - lambda^2) W + lambda E).
import { cross, dot, plus, times } from "./algebra.js";

function bernstein(degree, t) { // values and derivatives
	const row = (n) => Array.from({ length: n + 1 }, (_, i) => { let c = 1; for (let k = 1; k <= i; k++) c = (c * (n - k + 1)) / k; return c * Math.pow(t, i) * Math.pow(1 - t, n - i); });
	const values = row(degree), low = row(degree - 1);
	return { values, slopes: values.map((_, i) => degree * ((low[i - 1] || 0) - (low[i] || 0))) };
}

const sum = (weights, points) => points.reduce((p, q, i) => plus(p, q, weights[i]), [0, 0, 0]);

// Points and normals on a grid, and its triangles; null for values that no blend has.
export function sheet({ size: [n, m], closed, inward }, data, { l1, l2, lambda1, lambda2 }) {
	if (!(l1 > 0 && l2 > 0 && Math.abs(lambda1) < 1 && Math.abs(lambda2) < 1 && Number.isFinite(l1 + l2))) return null;
	const at = (row, i) => Array.from(data.subarray(3 * (row * n + i), 3 * (row * n + i) + 3)), middle = data.length > 36 * n;
	const leg = (first, i, length, slant) => { // a control point and its derivative in s
		const rest = Math.sqrt(1 - slant * slant), along = (k) => plus(times(at(first + 2 + k, i), rest), at(first + 4 + k, i), slant);
		return [0, 1].map((k) => plus(at(first + k, i), along(k), length));
	};
	const rows = Array.from({ length: m }, (_, j) => bernstein(middle ? 4 : 3, j / (m - 1))), points = new Float64Array(3 * n * m), normals = new Float32Array(3 * n * m);
	for (let i = 0; i < n; i++) {
		const ends = (first) => [at(first, i), at(first + 1, i)];
		const controls = [ends(0), leg(0, i, l1, lambda1), ...(middle ? [ends(12)] : []), leg(6, i, l2, lambda2), ends(6)], place = controls.map((c) => c[0]), change = controls.map((c) => c[1]);
		rows.forEach(({ values, slopes }, j) => {
			const normal = cross(sum(values, change), sum(slopes, place)), length = Math.sqrt(dot(normal, normal)) || 1;
			points.set(sum(values, place), 3 * (i * m + j)); normals.set(times(normal, (inward ? -1 : 1) / length), 3 * (i * m + j));
		});
	}
	const triangles = [];
	for (let i = 0; i < (closed ? n : n - 1); i++)
		for (let j = 0; j + 1 < m; j++) {
			const a = i * m + j, b = ((i + 1) % n) * m + j;
			triangles.push(...(inward ? [b + 1, b, a, a + 1, b + 1, a] : [a, b, b + 1, a, b + 1, a + 1]));
		}
	return { points, normals, triangles: new Uint32Array(triangles) };
}
