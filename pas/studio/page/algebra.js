// Vectors, matrices, and polynomials in three variables that are moved along with the camera.
// Monomials are listed by degree, inside one in descending lexicographic order, as in pas.algebra.monomials.

export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const plus = (a, b, s = 1) => [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]];
export const minus = (a, b) => plus(a, b, -1);
export const times = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const size = (a) => Math.hypot(a[0], a[1], a[2]);
export const unit = (a) => times(a, 1 / size(a));
export const count = (n) => ((n + 1) * (n + 2) * (n + 3)) / 6;

// The place of x^a y^b z^c.
export const place = (a, b, c) => {
	const d = a + b + c, r = b + c;
	return (d * (d + 1) * (d + 2)) / 6 + (r * (r + 1)) / 2 + c;
};

export function exponents(n) {
	const all = [];
	for (let d = 0; d <= n; d++) for (let a = d; a >= 0; a--) for (let b = d - a; b >= 0; b--) all.push([a, b, d - a - b]);
	return all;
}

// The inverse of a matrix of three columns, as rows.
export function inverse(x, y, z) {
	const a = cross(y, z), s = 1 / dot(x, a);
	return [times(a, s), times(cross(z, x), s), times(cross(x, y), s)];
}

// Coefficients of f(x + c).
export function shifted(f, n, c) {
	const p = Float64Array.from(f);
	for (let axis = 0; axis < 3; axis++)
		for (let i = 0; i <= n; i++)
			for (let j = 0; i + j <= n; j++) {
				const m = n - i - j, at = (k) => (axis === 0 ? place(k, i, j) : axis === 1 ? place(i, k, j) : place(i, j, k));
				for (let low = 0; low < m; low++) for (let k = m - 1; k >= low; k--) p[at(k)] += c[axis] * p[at(k + 1)];
			}
	return p;
}

// Moves polynomials of degree n by linear maps: of f, `apply` gives f(M X), degree by degree.
export class Turn {
	constructor(n) {
		this.all = exponents(n);
		this.rows = this.all.map(([a, b, c]) => new Float64Array(((a + b + c + 1) * (a + b + c + 2)) / 2));
		this.start = this.all.map(([a, b, c]) => place(a + b + c, 0, 0));
		this.parent = this.all.map(([a, b, c]) => (a ? [place(a - 1, b, c), 0] : b ? [place(0, b - 1, c), 1] : [c ? place(0, 0, c - 1) : 0, 2]));
	}
	set(rows) { // of M, each the coefficients of x, y or z in X, Y, Z
		this.rows[0][0] = 1;
		for (let i = 1; i < this.all.length; i++) {
			const [p, axis] = this.parent[i], from = this.rows[p], to = this.rows[i], [mx, my, mz] = rows[axis];
			to.fill(0);
			for (let k = 0, r = 0, c = 0; k < from.length; k++) { // of X^(d-r) Y^(r-c) Z^c
				const x = from[k];
				to[k] += x * mx;
				to[((r + 1) * (r + 2)) / 2 + c] += x * my;
				to[((r + 1) * (r + 2)) / 2 + c + 1] += x * mz;
				if (++c > r) { r++; c = 0; }
			}
		}
		return this;
	}
	apply(f, out) {
		out.fill(0);
		for (let i = 0; i < this.all.length; i++) {
			const row = this.rows[i], s = this.start[i], x = f[i];
			if (x) for (let k = 0; k < row.length; k++) out[s + k] += x * row[k];
		}
		return out;
	}
}
