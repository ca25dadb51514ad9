// Draws a scene: cells by casting rays (see shaders.js), triangle meshes, and lines, with one depth.
import { Turn, cross, dot, inverse, minus, plus, shifted, size, times, unit } from "./algebra.js";
import { BODY_VERTEX, LINE_FRAGMENT, LINE_VERTEX, MESH_VERTEX, PROBE, bodyFragment, meshFragment } from "./shaders.js";

const GROWN = 4e-3; // of proxies, which lose single pixels along edges else; the fragment clips
const SLACK = 2e-6; // of walls between cells, in barycentric coordinates, so that no ray slips through
export const NOTHING = -1e6;
const MARGIN = 1.3; // of the depth range

const packed = (n) => new Float32Array(4 * Math.ceil(n / 4)); // in fours, as graphics cards have numbers
const columns = (x, y, z) => [...x, ...y, ...z];
const transposed = ([x, y, z]) => [0, 1, 2].map((i) => [x[i], y[i], z[i]]);

// Where one looks from: `towards` is a unit vector from the target to the eye, `wide` the half height in view.
export class Camera {
	constructor() { this.towards = unit([0.62, -0.62, 0.48]); this.up = [0, 0, 1]; this.target = [0, 0, 0]; this.wide = 1.5; this.far = 9; }
	frame(aspect) {
		const eye = plus(this.target, this.towards, this.far), ahead = times(this.towards, -1);
		const side = unit(cross(ahead, this.up)), up = cross(side, ahead), tan = this.wide / this.far;
		return { eye, ahead, side, up, tan, across: tan * aspect };
	}
	project(point, aspect) { // to [-1, 1] x [-1, 1], and the depth
		const f = this.frame(aspect), q = minus(point, f.eye), deep = dot(q, f.ahead);
		return [dot(q, f.side) / deep / f.across, dot(q, f.up) / deep / f.tan, deep];
	}
}

// A convex body with a polynomial: `planes` [a, b, c, d] with a x + b y + c z + d >= 0 inside, `faces` of triangles.
function body(degree, number, planes, slacks, faces, aside) {
	const all = faces.flat(), middle = times(all.reduce((s, p) => plus(s, p), [0, 0, 0]), 1 / all.length);
	return { degree, number, planes, slacks, faces, middle, aside, moved: null };
}

export function tetrahedra(vertices, cells, pieces, shared) {
	const behind = new Map(), across = (cell, k) => cell.filter((_, i) => i !== k).sort((a, b) => a - b).join(); // pieces at a wall
	cells.forEach((cell, c) => { for (let k = 0; k < 4; k++) { const wall = across(cell, k); behind.set(wall, (behind.get(wall) || new Set()).add(pieces[c])); } });
	return cells.map((cell, c) => {
		const v = cell.map((i) => vertices[i]), planes = [], faces = [];
		let seams = 0;
		for (let k = 0; k < 4; k++) {
			if (behind.get(across(cell, k)).size > 1) seams |= 1 << k;
			const [a, b, d] = [0, 1, 2, 3].filter((i) => i !== k).map((i) => v[i]);
			const normal = cross(minus(b, a), minus(d, a)), scale = 1 / dot(normal, minus(v[k], a));
			planes.push([...times(normal, scale), -dot(normal, a) * scale]);
			faces.push([a, b, d]);
		}
		return { ...body(0, pieces[c], planes, shared[c].map((s) => (s ? SLACK : 0)), faces, false), cell: c, seams, heights: planes.map((p) => 1 / size(p)) };
	});
}

// A box around `middle` with three half edges, and further planes.
export function box(degree, number, middle, halves, more) {
	const corner = (i, j, k) => [i, j, k].reduce((p, s, n) => plus(p, halves[n], s), middle), planes = [], faces = [];
	for (let n = 0; n < 3; n++)
		for (const s of [-1, 1]) {
			const w = times(halves[n], -s / dot(halves[n], halves[n])), at = (i, j) => { const q = [0, 0, 0]; q[n] = s; q[(n + 1) % 3] = i; q[(n + 2) % 3] = j; return corner(...q); };
			planes.push([...w, 1 - dot(w, middle)]);
			faces.push([at(-1, -1), at(1, -1), at(1, 1), at(-1, -1), at(1, 1), at(-1, 1)]);
		}
	return body(degree, number, [...planes, ...more], [...planes.map(() => 0), ...more.map(() => SLACK)], faces, true);
}

export class Caster {
	constructor(canvas) {
		const gl = canvas.getContext("webgl2", { antialias: false, preserveDrawingBuffer: true, powerPreference: "high-performance" });
		if (!gl) throw new Error("This browser has no WebGL 2, with which the picture is drawn.");
		this.gl = gl; this.canvas = canvas; this.programs = new Map(); this.turns = new Map();
		this.bodies = []; this.polynomials = []; this.meshes = []; this.lines = []; this.substitute = []; this.reach = 2;
		gl.enable(gl.DEPTH_TEST); gl.depthFunc(gl.LEQUAL);
	}
	// The surface's cells and its neighbours' boxes; `polynomials` by number.
	scene(bodies, polynomials, reach) {
		const gl = this.gl, flat = [];
		for (const b of bodies) {
			b.start = b.faces.map((face) => { const s = flat.length / 3; for (const p of face) flat.push(...times(minus(p, b.middle), 1 + GROWN)); return s; });
			b.counts = b.faces.map((face) => face.length);
		}
		if (this.cells) { gl.deleteBuffer(this.cells.buffer); gl.deleteVertexArray(this.cells.array); }
		this.cells = this.upload(new Float32Array(flat), [["corner", 3]]);
		this.bodies = bodies; this.reach = reach; this.change(polynomials);
	}
	change(polynomials) { // the same cells with other coefficients
		this.polynomials = polynomials; this.drop(this.substitute); this.substitute = [];
		for (const b of this.bodies) { const { degree, values, clips } = polynomials[b.number]; b.degree = degree; b.moved = shifted(values, degree, b.middle); b.turned = new Float64Array(values.length); b.packed = packed(values.length); b.rest = packed(values.length); b.clips = clips.map((c) => ({ degree: c.degree, moved: shifted(c.values, c.degree, b.middle), turned: new Float64Array(c.values.length) })); }
	}
	upload(data, parts, indices) {
		const gl = this.gl, array = gl.createVertexArray(), buffer = gl.createBuffer(), stride = 4 * parts.reduce((s, [, n]) => s + n, 0);
		gl.bindVertexArray(array); gl.bindBuffer(gl.ARRAY_BUFFER, buffer); gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
		parts.reduce((at, [, n], k) => { gl.enableVertexAttribArray(k); gl.vertexAttribPointer(k, n, gl.FLOAT, false, stride, at); return at + 4 * n; }, 0);
		let order = null;
		if (indices) { order = gl.createBuffer(); gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, order); gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, indices, gl.STATIC_DRAW); }
		return { array, buffer, order, count: indices ? indices.length : (4 * data.length) / stride };
	}
	drop(list) { for (const m of list) { for (const b of [m.buffer, m.order, m.shifts]) this.gl.deleteBuffer(b ?? null); this.gl.deleteVertexArray(m.array); } }
	// Of { points, normals, triangles, tints }, tints of red, green, blue, mean and Gauss curvature, and `places` of what stands in many.
	setMeshes(meshes) {
		this.drop(this.meshes); this.meshes = this.uploaded(meshes);
	}
	setSubstitute(mesh) { this.drop(this.substitute); this.substitute = this.uploaded([mesh]); } // of the cells
	uploaded(meshes) {
		return meshes.map((m) => {
			const n = m.points.length / 3, data = new Float32Array(11 * n);
			for (let i = 0; i < n; i++) { data.set(m.points.subarray(3 * i, 3 * i + 3), 11 * i); data.set(m.normals.subarray(3 * i, 3 * i + 3), 11 * i + 3); data.set(m.tints.subarray(5 * i, 5 * i + 5), 11 * i + 6); }
			const made = this.upload(data, [["corner", 3], ["normal", 3], ["tint", 3], ["bent", 2]], m.triangles);
			return m.places ? this.placed(made, m.places) : { ...made, many: 1 };
		});
	}
	placed(made, places) { // attribute 4 is a shift for each place, and zero of what has none
		const gl = this.gl, shifts = gl.createBuffer();
		gl.bindVertexArray(made.array); gl.bindBuffer(gl.ARRAY_BUFFER, shifts); gl.bufferData(gl.ARRAY_BUFFER, places, gl.STATIC_DRAW);
		gl.enableVertexAttribArray(4); gl.vertexAttribPointer(4, 3, gl.FLOAT, false, 0, 0); gl.vertexAttribDivisor(4, 1);
		return { ...made, shifts, many: places.length / 3 };
	}
	setLines(sets) { // of { data: corners and colours, lift }
		this.drop(this.lines);
		this.lines = sets.map((s) => ({ ...this.upload(new Float32Array(s.data), [["corner", 3], ["tint", 4]]), lift: s.lift || 0 }));
	}
	program(vertex, fragment, names) {
		const key = fragment + vertex, known = this.programs.get(key);
		if (known) return known;
		const gl = this.gl, program = gl.createProgram();
		for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
			const s = gl.createShader(kind); gl.shaderSource(s, text); gl.compileShader(s);
			if (!gl.getShaderParameter(s, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(s) || "a shader was refused");
			gl.attachShader(program, s);
		}
		names.forEach((name, k) => gl.bindAttribLocation(program, k, name));
		gl.linkProgram(program);
		if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program) || "a program was refused");
		const at = {};
		for (let i = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); i--; ) { const { name } = gl.getActiveUniform(program, i); at[name.replace("[0]", "")] = gl.getUniformLocation(program, name); }
		const made = { program, at };
		this.programs.set(key, made);
		return made;
	}
	bodyProgram(degree, mode, aside, fine, clips) { // the text is made once
		const key = `${degree} ${mode} ${aside} ${fine} ${clips}`;
		if (!this.programs.has(key)) this.programs.set(key, this.program(BODY_VERTEX, bodyFragment(degree, mode, aside, fine, clips), ["corner"]));
		return this.programs.get(key);
	}
	turn(degree) { if (!this.turns.has(degree)) this.turns.set(degree, new Turn(degree)); return this.turns.get(degree); }
	// Draws everything: `look` has mode, range, section (a plane or null), colors, jitter, background,
	// `fine` at rest, `meshed` where the mesh of the surface is drawn in place of it.
	draw(camera, look, width = this.canvas.width, height = this.canvas.height) {
		const gl = this.gl, frame = camera.frame(width / height), middle = -dot(frame.eye, frame.ahead);
		const near = middle - MARGIN * this.reach, far = middle + MARGIN * this.reach, jitter = look.jitter || [0, 0];
		const light = plus(times(frame.up, 0.9), times(frame.side, -0.7)), bar = { ...frame, near, far, jitter, light, pixels: [width, height] };
		gl.viewport(0, 0, width, height); gl.clearColor(...(look.background || [0, 0, 0, 0])); gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
		const meshed = look.meshed && this.substitute.length > 0;
		this.drawBodies(bar, look, meshed); if (look.mode === PROBE) return;
		this.drawMeshes(bar, look, meshed ? this.substitute : this.meshes); this.drawLines(bar);
	}
	drawBodies(f, look, meshed) {
		const gl = this.gl; let last = null;
		if (this.cells) gl.bindVertexArray(this.cells.array);
		const sorted = this.bodies.map((b) => [dot(minus(b.middle, f.eye), f.ahead), b]).sort((a, b) => a[0] - b[0] || 0);
		for (const [deep, b] of sorted) {
			if (deep <= 0 || (meshed && !b.aside)) continue;
			const eye = minus(f.eye, b.middle), W = times(eye, -1 / deep), P = this.bodyProgram(b.degree, look.mode, b.aside, Boolean(look.fine) && !b.aside, b.clips.map((c) => c.degree)), at = P.at;
			if (last !== P) {
				gl.useProgram(P.program); last = P;
				gl.uniform1f(at.near, f.near); gl.uniform1f(at.far, f.far); gl.uniform2fv(at.pixels, f.pixels); gl.uniform2fv(at.jitter, f.jitter); gl.uniform3fv(at.light, f.light);
				gl.uniform3fv(at.ahead, f.ahead); gl.uniform3fv(at.rightwards, times(f.side, f.across)); gl.uniform3fv(at.upwards, times(f.up, f.tan));
				gl.uniform1f(at.range, look.range || 1); gl.uniform1f(at.one, 1);
				const c = b.aside ? look.colors.aside : look.colors.surface; gl.uniform3fv(at.outside, c.outside); gl.uniform3fv(at.inside, c.inside);
			}
			const rows = transposed([f.side, f.up, W]), inv = inverse(f.side, f.up, W);
			this.turn(b.degree).set(rows).apply(b.moved, b.turned); b.packed.set(b.turned); b.turned.forEach((x, i) => { b.rest[i] = x - b.packed[i]; }); gl.uniform4fv(at.A, b.packed); gl.uniform4fv(at.B, b.rest);
			b.clips.forEach((c, i) => { this.turn(c.degree).set(rows).apply(c.moved, c.turned); const C = packed(c.turned.length); C.set(c.turned); gl.uniform4fv(at[`C${i}`], C); });
			const planes = look.section ? [...b.planes, look.section] : b.planes, slack = (k) => b.slacks[k] || 0;
			gl.uniform4fv(at.planes, planes.flatMap((p, k) => [dot(p, f.side), dot(p, f.up), dot(p, W), p[3] + dot(p, b.middle) + slack(k)])); gl.uniform1i(at.sides, planes.length);
			if (!b.aside) { gl.uniform1i(at.seams, look.wire ? b.seams : 0); gl.uniform4fv(at.heights, b.heights); }
			 gl.uniform1i(at.inner, b.aside ? 0 : b.slacks.reduce((bits, s, k) => bits | (s > 0 ? 1 << k : 0), 0));
			gl.uniform4f(at.view, deep * f.across, deep * f.tan, dot(eye, f.side), dot(eye, f.up)); gl.uniform1f(at.bend, 1 / deep); gl.uniform1f(at.distance0, deep);
			gl.uniform1f(at.number, b.aside ? -1 - b.number : b.cell);
			gl.uniformMatrix3fv(at.inverse, false, columns(...transposed(inv))); gl.uniformMatrix3fv(at.toWorld, false, columns(...inv));
			b.faces.forEach((_, k) => { const p = b.planes[k]; if (dot(p, f.eye) + p[3] > 0) gl.drawArrays(gl.TRIANGLES, b.start[k], b.counts[k]); }); // far faces: one fragment a pixel
		}
	}
	common(P, f) {
		const gl = this.gl, at = P.at;
		gl.useProgram(P.program); gl.uniformMatrix3fv(at.toEye, false, columns(...transposed([f.side, f.up, f.ahead]))); gl.uniform3fv(at.eye, f.eye);
		gl.uniform2f(at.tan0, f.across, f.tan); gl.uniform1f(at.near, f.near); gl.uniform1f(at.far, f.far); gl.uniform2fv(at.jitter, f.jitter); gl.uniform2fv(at.pixels, f.pixels);
		return at;
	}
	drawMeshes(f, look, meshes) {
		if (!meshes.length) return;
		const gl = this.gl, at = this.common(this.program(MESH_VERTEX, meshFragment(look.mode), ["corner", "normal", "tint", "bent", "place"]), f);
		gl.uniform3fv(at.light, f.light); gl.uniform4fv(at.cut, look.section || [0, 0, 0, 1]); gl.uniform1f(at.range, look.range || 1);
		for (const m of meshes) { gl.bindVertexArray(m.array); gl.drawElementsInstanced(gl.TRIANGLES, m.count, gl.UNSIGNED_INT, 0, m.many); }
	}
	drawLines(f) {
		if (!this.lines.length) return;
		const gl = this.gl, at = this.common(this.program(LINE_VERTEX, LINE_FRAGMENT, ["corner", "tint"]), f);
		gl.enable(gl.BLEND); gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
		for (const l of this.lines) { gl.uniform1f(at.lift, l.lift); gl.bindVertexArray(l.array); gl.drawArrays(gl.LINES, 0, l.count); }
		gl.disable(gl.BLEND);
	}
	clear() { this.gl.clearColor(0, 0, 0, 0); this.gl.clear(this.gl.COLOR_BUFFER_BIT); }
	finish() { this.gl.readPixels(0, 0, 1, 1, this.gl.RGBA, this.gl.UNSIGNED_BYTE, new Uint8Array(4)); }
	// Depth, mean and Gauss curvature and the cell's number of each pixel, lowest row first: NOTHING where there is none,
	// and negative for neighbours.
	probe(camera, look, width, height) {
		const gl = this.gl;
		if (!gl.getExtension("EXT_color_buffer_float")) return null;
		const texture = gl.createTexture(), depth = gl.createRenderbuffer(), target = gl.createFramebuffer(), found = new Float32Array(4 * width * height);
		gl.bindTexture(gl.TEXTURE_2D, texture); gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32F, width, height);
		gl.bindRenderbuffer(gl.RENDERBUFFER, depth); gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT24, width, height);
		gl.bindFramebuffer(gl.FRAMEBUFFER, target); gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0); gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, depth);
		this.draw(camera, { ...look, mode: PROBE, fine: true, jitter: [0, 0], background: [0, 0, 0, NOTHING] }, width, height);
		gl.readPixels(0, 0, width, height, gl.RGBA, gl.FLOAT, found);
		gl.bindFramebuffer(gl.FRAMEBUFFER, null); gl.deleteTexture(texture); gl.deleteRenderbuffer(depth); gl.deleteFramebuffer(target);
		return found;
	}
}
