// What is drawn, from messages.
import { box, tetrahedra } from "./cast.js";
import { count, minus, size } from "./algebra.js";
import { sheet } from "./sheet.js";

const rows = (flat, n) => Array.from({ length: flat.length / n }, (_, i) => Array.from(flat.subarray(n * i, n * i + n)));
const rgb = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);

// The head and the arrays of a packed message.
export function unpacked(buffer) {
	const length = new DataView(buffer).getUint32(0, true), head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
	let at = 4 + length;
	const arrays = {};
	for (const [name, type, n] of head.arrays) {
		const made = array(buffer, type, at, n);
		arrays[name] = made;
		at += 8 * Math.ceil(made.byteLength / 8);
	}
	return { head, arrays };
}

export function array(buffer, type, at, n) {
	const Kind = { float64: Float64Array, float32: Float32Array, uint32: Uint32Array, uint8: Uint8Array }[type];
	return new Kind(buffer, at, n);
}

const pieces = (values, degree) => Array.from({ length: values.length / count(degree) }, (_, i) => ({ degree, values: values.subarray(i * count(degree), (i + 1) * count(degree)) }));

// The middle of the box around points, and how far from there they are.
function around(points) {
	const middle = [0, 1, 2].map((i) => (Math.min(...points.map((p) => p[i])) + Math.max(...points.map((p) => p[i]))) / 2);
	return { middle, round: Math.max(...points.map((p) => size(minus(p, middle)))) };
}

export class Scene {
	constructor(head, arrays) {
		Object.assign(this, { head, how: head.how, origin: head.origin, scale: head.scale, beyond: [] });
		if (head.how === "cast") this.cast(head, arrays); else this.triangles(head, arrays);
	}
	cast(head, arrays) {
		this.vertices = rows(arrays.vertices, 3); this.cells = rows(arrays.cells, 4);
		let at = 0;
		this.clips = head.clips.map((degree) => ({ degree, values: arrays.clips.subarray(at, (at += count(degree))) }));
		this.moved(arrays.coefficients, head.exponent);
		this.tetrahedra = tetrahedra(this.vertices, this.cells, [...arrays.pieces], rows(arrays.inner, 4));
		this.outlined(head, arrays);
		this.reach = Math.max(...this.bodies.flatMap((b) => b.faces.flat().map(size)));
		const ends = this.bodies.filter((b) => b.aside); // the surface is between its neighbours
		Object.assign(this, around((ends.length > 1 ? ends : this.bodies).flatMap((b) => b.faces.flat())));
		this.meshes = [];
	}
	outlined(head, arrays) { // neighbours in the same frame; false in another one
		if (head.scale !== this.scale || head.origin.some((x, i) => x !== this.origin[i])) return false;
		let at = 0;
		const next = (degree) => ({ degree, values: arrays.neighbours.subarray(at, (at += count(degree))) });
		this.beyond = head.beyond.map((b) => ({ ...next(b.degree), clips: b.clips.map(next) }));
		this.bodies = [...this.tetrahedra, ...head.beyond.map((b, i) => box(b.degree, this.surface.length + i, b.middle, b.halves, b.clip ? [b.clip] : []))];
		return true;
	}
	triangles(head, arrays) {
		this.legs = arrays.legs; this.middle = [0, 0, 0]; // of the server's box around them
		this.vertices = []; this.cells = []; this.bodies = []; this.surface = []; this.reach = 0;
		this.meshes = head.colors.map((color, i) => {
			const points = arrays[`points ${i}`], places = arrays[`places ${i}`], n = points.length / 3, tints = new Float32Array(5 * n), bent = arrays[`bent ${i}`];
			const farthest = (p) => { let most = 0; for (let k = 0; k < p.length; k += 3) most = Math.max(most, Math.hypot(p[k], p[k + 1], p[k + 2])); return most; };
			this.reach = Math.max(this.reach, farthest(points) + (places ? farthest(places) : 0));
			for (let k = 0; k < n; k++) tints.set([...rgb(color), bent ? bent[2 * k] : NaN, bent ? bent[2 * k + 1] : NaN], 5 * k);
			return { points, normals: arrays[`normals ${i}`], triangles: arrays[`triangles ${i}`], tints, places };
		});
		this.round = this.reach;
	}
	// The main part of a blend by a generatrix for other shape values; false where the server has to be asked.
	generated(values) {
		const made = this.head.legs && sheet(this.head.legs, this.legs, { ...this.head.legs.values, ...values });
		if (made) this.movedMesh({ "points 0": made.points, "normals 0": made.normals, "triangles 0": made.triangles });
		return Boolean(made);
	}
	movedMesh(arrays) { // the main part alone, in the shape's own coordinates
		const p = arrays["points 0"], points = new Float32Array(p.length), n = p.length / 3, tints = new Float32Array(5 * n), color = rgb(this.head.colors[this.head.main]);
		for (let i = 0; i < p.length; i++) points[i] = (p[i] - this.origin[i % 3]) / this.scale;
		for (let i = 0; i < n; i++) tints.set([...color, NaN, NaN], 5 * i);
		this.meshes[this.head.main] = { points, normals: arrays["normals 0"], triangles: arrays["triangles 0"], tints };
	}
	substitute(arrays, color) { // the mesh of the surface
		const n = arrays["points 0"].length / 3, bent = arrays["bent 0"], tints = new Float32Array(5 * n);
		for (let i = 0; i < n; i++) tints.set([...color, bent[2 * i], bent[2 * i + 1]], 5 * i);
		return { points: arrays["points 0"], normals: arrays["normals 0"], triangles: arrays["triangles 0"], tints };
	}
	get polynomials() { return [...this.surface, ...this.beyond]; }
	moved(values, exponent) { this.exponent = exponent; this.surface = pieces(values, this.head.degree).map((p) => ({ ...p, clips: this.clips })); }
	load(caster) { caster.scene(this.bodies, this.polynomials, this.reach); caster.setMeshes(this.meshes); }
	local(p) { return p.map((x, i) => (x - this.origin[i]) / this.scale); }
	world(p) { return p.map((x, i) => x * this.scale + this.origin[i]); }
	// Each edge of the cells once, as points.
	get edges() {
		const found = new Map();
		for (const c of this.cells) for (let i = 0; i < 4; i++) for (let j = i + 1; j < 4; j++) found.set([c[i], c[j]].sort((a, b) => a - b).join(), [this.vertices[c[i]], this.vertices[c[j]]]);
		return [...found.values()];
	}
}
