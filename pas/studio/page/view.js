// The picture: a camera for pointer, touch and keys; quick frames while anything moves, smooth ones at rest.
import { Camera, Caster } from "./cast.js";
import { minus, plus, size, unit } from "./algebra.js";

const SLOW = 60; // milliseconds of a frame from which moving ones are drawn coarser
const TOO_SLOW = 150, CRAWLS = 3; // milliseconds of a coarse frame, and frames, from which moving ones are drawn from a mesh
const STILL = 220, LONG = 900; // milliseconds of rest before the picture is smoothed, and drawn with more digits
const FILM = 90, FRAME = 40; // frames of a turn, and milliseconds of each
const SMOOTH = [[0.25, 0.125], [-0.25, -0.125], [-0.125, 0.375], [0.125, -0.375], [0.375, -0.25], [-0.375, 0.25]];

export const VIEWS = { Oblique: [0.62, -0.62, 0.48], Front: [0, -1, 0], Back: [0, 1, 0], Left: [-1, 0, 0], Right: [1, 0, 0], Top: [0, 0, 1], Bottom: [0, 0, -1] };

export const COLORS = {
	surface: { outside: [0.91, 0.6, 0.2], inside: [0.5, 0.42, 0.36] },
	aside: { outside: [0.68, 0.73, 0.78], inside: [0.42, 0.46, 0.52] },
};

export class View {
	constructor(place, overlay) {
		this.live = place.appendChild(document.createElement("canvas")); this.still = place.appendChild(document.createElement("canvas"));
		this.sum = document.createElement("canvas"); this.live.className = "live"; this.still.className = "still"; this.live.tabIndex = 0; this.live.setAttribute("role", "img");
		this.live.setAttribute("aria-label", "The surface. Drag or use the arrow keys to turn it, plus and minus to zoom, Home to go back.");
		this.place = place; this.overlay = overlay; this.camera = new Camera(); this.caster = new Caster(this.live);
		this.look = { mode: "shaded", range: 1, section: null, colors: COLORS }; this.coarse = 1; this.frames = this.crawls = 0; this.tooSlow = false; this.pointers = new Map(); this.lineSets = {};
		this.onpick = this.onfinger = null; this.listen();
		this.observer = new ResizeObserver(() => this.ask()); this.observer.observe(place);
	}
	destroy() { this.observer.disconnect(); clearTimeout(this.resting); cancelAnimationFrame(this.asked); this.caster.gl.getExtension("WEBGL_lose_context")?.loseContext(); }
	load(scene, keep) { this.scene = scene; scene.load(this.caster); if (!keep) this.fit(); this.ask(); }
	fit() { this.camera.target = this.scene.middle; this.camera.wide = 1.02 * this.whole; this.ask(); }
	setLines(name, data, lift) { if (data && data.length) this.lineSets[name] = { data, lift }; else delete this.lineSets[name]; this.caster.setLines(Object.values(this.lineSets)); this.ask(); }
	get whole() { return this.scene.round / Math.min(1, this.aspect); } // half the height that shows everything
	get aspect() { return this.place.clientWidth / Math.max(1, this.place.clientHeight); }
	ask() { // a frame, soon
		clearTimeout(this.resting); this.still.hidden = true;
		if (!this.asked) this.asked = requestAnimationFrame(() => { this.asked = 0; this.now(); });
	}
	sized(share) {
		const w = Math.max(1, Math.round(this.place.clientWidth * share)), h = Math.max(1, Math.round(this.place.clientHeight * share));
		if (this.live.width !== w || this.live.height !== h) { this.live.width = w; this.live.height = h; }
	}
	now() {
		const began = performance.now();
		this.sized(this.coarse); this.caster.draw(this.camera, { ...this.look, meshed: this.tooSlow, jitter: [0, 0] }); this.caster.finish(); this.frames++;
		const spent = performance.now() - began;
		this.spent = spent; this.drawn = began + spent;
		if (spent > SLOW && this.coarse > 0.4) this.coarse *= 0.7; else if (spent < SLOW / 4 && this.coarse < 1) this.coarse = Math.min(1, this.coarse / 0.7);
		this.crawls = spent > TOO_SLOW && this.coarse <= 0.5 ? this.crawls + 1 : 0;
		if (this.crawls === CRAWLS && !this.tooSlow) { this.tooSlow = true; this.onslow?.(); }
		this.overlay(this);
		clearTimeout(this.resting); this.resting = setTimeout(() => this.smooth(0), STILL);
	}
	smooth(step, fine = false) { // the mean of shifted frames, one at a time; after a longer rest once more with more digits
		const share = Math.min(2, devicePixelRatio || 1), context = this.sum.getContext("2d"), began = performance.now();
		this.sized(share);
		if (step === 0) { this.sum.width = this.live.width; this.sum.height = this.live.height; }
		this.caster.draw(this.camera, { ...this.look, fine, jitter: SMOOTH[step] });
		if (this.tooSlow) { this.caster.finish(); if (performance.now() - began < TOO_SLOW / 2) { this.tooSlow = false; this.crawls = 0; } } // it was busy with other things
		const steps = this.tooSlow ? 1 : SMOOTH.length;
		context.globalCompositeOperation = step ? "source-over" : "copy"; context.globalAlpha = 1 / (step + 1);
		if (step) { context.globalCompositeOperation = "destination-out"; context.fillRect(0, 0, this.sum.width, this.sum.height); context.globalCompositeOperation = "lighter"; }
		context.drawImage(this.live, 0, 0);
		if (!this.still.hidden) this.caster.clear(); // else its steps show around the smooth edges
		if (step + 1 < steps) { this.resting = setTimeout(() => this.smooth(step + 1, fine), 0); return; }
		this.still.width = this.sum.width; this.still.height = this.sum.height; this.still.getContext("2d").drawImage(this.sum, 0, 0);
		this.still.hidden = false; this.still.dataset.fine = fine; this.caster.clear();
		if (!fine && !this.tooSlow) this.resting = setTimeout(() => this.smooth(0, true), LONG);
	}
	// The picture at any size, with a plain background.
	async png(width, height, background) {
		const out = new OffscreenCanvas(width, height), context = out.getContext("2d"), before = [this.live.width, this.live.height], gl = this.caster.gl, n = SMOOTH.length;
		const one = new Uint8Array(4 * width * height), sum = new Uint16Array(one.length); // a sum of rounded shares would show bands
		this.live.width = width; this.live.height = height;
		for (const jitter of SMOOTH) {
			this.caster.draw(this.camera, { ...this.look, fine: true, jitter }); gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, one);
			for (let i = 0; i < one.length; i++) sum[i] += one[i];
		}
		[this.live.width, this.live.height] = before; this.ask();
		context.fillStyle = background; context.fillRect(0, 0, width, height);
		const image = context.getImageData(0, 0, width, height), row = 4 * width;
		for (let i = 0; i < one.length; i += 4) { // rows of the one from below, of the other from above; colours are times their alpha
			const k = (height - 1 - Math.floor(i / row)) * row + (i % row), behind = 1 - sum[i + 3] / (255 * n);
			for (let c = 0; c < 3; c++) image.data[k + c] = sum[i + c] / n + behind * image.data[k + c];
		}
		context.putImageData(image, 0, 0);
		return out.convertToBlob({ type: "image/png" });
	}
	// One turn about the vertical as a film: a blob of WebM.
	async film(background, frames = FILM) {
		const { towards, up } = this.camera, wait = (t) => new Promise((r) => setTimeout(r, t)), out = document.createElement("canvas"), add = out.getContext("2d");
		this.sized(1); out.width = this.live.width; out.height = this.live.height;
		const stream = out.captureStream(0), recorder = new MediaRecorder(stream, { mimeType: "video/webm", videoBitsPerSecond: 6e6 }), parts = [];
		recorder.ondataavailable = (e) => parts.push(e.data); recorder.start();
		for (let i = 0; i < frames; i++) {
			const began = performance.now(), a = (2 * Math.PI * i) / frames, c = Math.cos(a), s = Math.sin(a);
			this.camera.towards = [c * towards[0] - s * towards[1], s * towards[0] + c * towards[1], towards[2]]; this.camera.up = [0, 0, 1];
			clearTimeout(this.resting); this.sized(1); this.caster.draw(this.camera, { ...this.look, jitter: [0, 0] });
			add.fillStyle = background; add.fillRect(0, 0, out.width, out.height); add.drawImage(this.live, 0, 0);
			stream.getVideoTracks()[0].requestFrame(); this.overlay(this);
			await wait(Math.max(4, FRAME - (performance.now() - began)));
		}
		const done = new Promise((r) => { recorder.onstop = r; });
		recorder.stop(); await done; stream.getTracks().forEach((track) => track.stop());
		this.camera.towards = towards; this.camera.up = up; this.ask();
		return new Blob(parts, { type: "video/webm" });
	}
	turn(right, up) {
		const f = this.camera.frame(1), way = plus(plus(this.camera.towards, f.side, -right), f.up, up);
		const next = unit(way);
		if (Math.abs(next[2]) < 0.999) { this.camera.towards = next; this.camera.up = [0, 0, 1]; }
		this.ask();
	}
	aim(way) { const w = unit(way); this.camera.towards = Math.abs(w[2]) > 0.99 ? unit([0.002, -0.02, Math.sign(w[2])]) : w; this.camera.up = [0, 0, 1]; this.ask(); }
	zoom(factor) { this.camera.wide = Math.min(4 * this.whole, Math.max(0.02, this.camera.wide * factor)); this.ask(); }
	pan(dx, dy) { // in shares of the height
		const f = this.camera.frame(1), s = 2 * this.camera.wide, moved = plus(plus(this.camera.target, f.side, -dx * s), f.up, dy * s);
		if (size(minus(moved, this.scene.middle)) < 2 * this.scene.round) this.camera.target = moved;
		this.ask();
	}
	pinch(before, now, other) { // one of two fingers moves: what was in the middle of them stays there
		const apart = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]) || 1, wide = this.camera.wide, h = this.place.clientHeight;
		this.zoom(apart(before) / apart(now));
		const k = wide / this.camera.wide, off = (p, i, full) => (p[i] + other[i] - full) / 2;
		this.pan(...[this.place.clientWidth, h].map((full, i) => (off(now, i, full) - k * off(before, i, full)) / h));
	}
	toScreen(point) { const [x, y, deep] = this.camera.project(point, this.aspect); return [((x + 1) / 2) * this.place.clientWidth, ((1 - y) / 2) * this.place.clientHeight, deep]; }
	// A point at a place on the screen, as deep as another one.
	fromScreen(x, y, deep) {
		const f = this.camera.frame(this.aspect), s = ((2 * x) / this.place.clientWidth - 1) * f.across, t = (1 - (2 * y) / this.place.clientHeight) * f.tan;
		return plus(plus(plus(f.eye, f.ahead, deep), f.side, deep * s), f.up, deep * t);
	}
	// What is seen at a place: its depth, curvatures and cell, or null.
	pick(x, y) {
		const w = Math.round(this.place.clientWidth), h = Math.round(this.place.clientHeight), all = this.caster.probe(this.camera, this.look, w, h);
		if (!all) return null;
		const at = 4 * ((h - 1 - Math.min(h - 1, Math.floor(y))) * w + Math.min(w - 1, Math.floor(x)));
		this.ask();
		return all[at + 3] >= 0 ? { point: this.fromScreen(x, y, all[at]), mean: all[at + 1], gauss: all[at + 2], cell: all[at + 3] } : null;
	}
	listen() {
		const c = this.live, at = (e) => { const r = c.getBoundingClientRect(); return [e.clientX - r.left, e.clientY - r.top]; };
		this.take = (e, sure = false) => { // a pointer that the picture follows from now on, if no mark wants it
			if (!sure && e.pointerType === "touch" && this.onfinger?.(e, at(e))) return;
			this.dragged = this.pointers.size ? Infinity : 0; // two fingers are no click
			c.focus({ preventScroll: true }); try { c.setPointerCapture(e.pointerId); } catch { /* no real pointer */ }
			this.pointers.set(e.pointerId, at(e));
		};
		c.addEventListener("pointerdown", (e) => this.take(e));
		c.addEventListener("pointermove", (e) => {
			const before = this.pointers.get(e.pointerId); if (!before) return;
			const now = at(e), dx = now[0] - before[0], dy = now[1] - before[1], h = this.place.clientHeight;
			this.dragged += Math.abs(dx) + Math.abs(dy);
			if (this.pointers.size > 1) this.pinch(before, now, [...this.pointers].find(([id]) => id !== e.pointerId)[1]);
			else if (e.shiftKey || e.buttons === 4 || e.buttons === 2) this.pan(dx / h, dy / h); else this.turn((dx * 3.2) / h, (dy * 3.2) / h);
			this.pointers.set(e.pointerId, now);
		});
		const end = (e) => { const p = this.pointers.get(e.pointerId); this.pointers.delete(e.pointerId); if (p && this.dragged < 4 && e.type === "pointerup" && this.onpick) this.onpick(...p); };
		c.addEventListener("pointerup", end); c.addEventListener("pointercancel", end);
		c.addEventListener("contextmenu", (e) => e.preventDefault());
		c.addEventListener("wheel", (e) => { e.preventDefault(); this.zoom(Math.exp(Math.sign(e.deltaY) * 0.12)); }, { passive: false });
		c.addEventListener("keydown", (e) => {
			if (e.ctrlKey || e.metaKey || e.altKey) return;
			const s = 0.12, act = { ArrowLeft: () => this.turn(-s, 0), ArrowRight: () => this.turn(s, 0), ArrowUp: () => this.turn(0, -s), ArrowDown: () => this.turn(0, s), "+": () => this.zoom(0.87), "=": () => this.zoom(0.87), "-": () => this.zoom(1.15), Home: () => { this.aim(VIEWS.Oblique); this.fit(); } }[e.key];
			if (act) { act(); e.preventDefault(); }
		});
	}
}
