// Controls from the server's descriptions: each slider has a field that takes any exact number, such as 1/3.

export const make = (tag, attributes = {}, ...inside) => {
	const e = document.createElement(tag);
	for (const [k, v] of Object.entries(attributes)) { if (k.startsWith("on")) e.addEventListener(k.slice(2), v); else if (v === true) e.setAttribute(k, ""); else if (v !== false && v != null) e.setAttribute(k, v); }
	e.append(...inside.filter((x) => x != null));
	return e;
};

export const svg = (tag, attributes, text) => {
	const e = document.createElementNS("http://www.w3.org/2000/svg", tag);
	for (const [k, v] of Object.entries(attributes)) e.setAttribute(k, v);
	if (text !== undefined) e.textContent = text;
	return e;
};

const EXACT = /^\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(?:\/\s*(\d+(?:\.\d*)?)\s*)?$/;

// The value of an exact number's text, or NaN.
export function number(text) {
	const found = EXACT.exec(String(text));
	if (!found) return NaN;
	const value = Number(found[1]) / (found[2] === undefined ? 1 : Number(found[2]));
	return Number.isFinite(value) ? value : NaN;
}

export const get = (data, path) => path.reduce((at, key) => (at == null ? undefined : at[key]), data);
export function put(data, path, value) { // a copy; undefined takes the key out
	const [key, ...rest] = path, copy = Array.isArray(data) ? [...data] : { ...data };
	const made = rest.length ? put(copy[key] ?? {}, rest, value) : value;
	if (made === undefined) delete copy[key]; else copy[key] = made;
	return copy;
}

const STEPS = 1000;
const plain = (value, span) => String(Number(value.toFixed(Math.max(0, Math.min(9, 3 - Math.floor(Math.log10(span)))))));

// `act.move(path, value)` while dragging, `act.commit()` when it is done, `act.wrong(text)` for what is no number.
export function numberControl(c, act, label = c.label, path = c.path) {
	const id = `c-${path.join("-")}`, bent = c.bent || 1, span = c.high - c.low;
	const slider = make("input", { type: "range", min: 0, max: STEPS, step: 1, id: `${id}-s`, "aria-label": `${c.group}, ${label}` });
	const field = make("input", { type: "text", id, autocomplete: "off", spellcheck: "false", "aria-label": `${c.group}, ${label}, exact value` });
	const to = (v) => Math.round(STEPS * Math.pow(Math.min(1, Math.max(0, (v - c.low) / span)), 1 / bent)), from = (s) => c.low + span * Math.pow(s / STEPS, bent);
	let moved = false;
	slider.addEventListener("input", () => { moved = true; const v = plain(from(Number(slider.value)), span); field.value = v; tell(v); act.move(path, v, c.slow); });
	slider.addEventListener("change", () => { if (moved) act.commit(); moved = false; });
	const take = () => {
		const text = field.value.trim();
		if (Number.isNaN(number(text))) { field.setAttribute("aria-invalid", "true"); act.wrong(`${c.group}, ${label}: ${text || "nothing"} is no number; write one like 0.4 or 1/3.`); return; }
		field.removeAttribute("aria-invalid"); if (text === field.dataset.value) return;
		slider.value = to(number(text)); act.move(path, text, true); act.commit();
	};
	field.addEventListener("change", take);
	field.addEventListener("keydown", (e) => { if (e.key === "Enter") take(); if (e.key === "Escape") { show(get(act.document(), path)); field.blur(); } });
	const tell = (v) => { slider.setAttribute("aria-valuetext", `${v}${c.ends ? (number(v) < number(c.usual ?? 0) ? `, towards ${c.ends[0]}` : `, towards ${c.ends[1]}`) : ""}`); };
	const show = (value) => { const v = String(value ?? c.usual ?? ""); field.dataset.value = v; if (!field.matches(":focus")) { field.value = v; field.removeAttribute("aria-invalid"); } slider.value = to(number(v)); tell(v); };
	const ends = c.ends ? make("span", { class: "ends", "aria-hidden": "true" }, make("span", {}, c.ends[0]), make("span", {}, c.ends[1])) : null;
	const safe = make("small", { class: "safe", hidden: true });
	const mark = (limits) => { const most = limits[path.at(-1)]; safe.hidden = most === undefined || most > c.high; if (!safe.hidden) { safe.textContent = `▲ safe up to ${Number(most.toPrecision(3))}`; safe.style.marginLeft = `${Math.min(45, (100 * (most - c.low)) / span)}%`; } };
	const tick = make("i", { class: "tick", hidden: true }), fair = make("small", { class: "safe", hidden: true });
	// The value at which the shape was last fair, where it is another one now; `doc` is the document that was fair, or null.
	const warn = (doc, now) => {
		const was = doc && number(get(doc, path) ?? c.usual), away = Boolean(doc) && was !== number(get(now, path) ?? c.usual) && Number.isFinite(was);
		tick.hidden = fair.hidden = !away; element.classList.toggle("away", away);
		if (away) { tick.style.setProperty("--at", to(was) / STEPS); fair.textContent = `▲ last fair at ${Number(was.toPrecision(4))}`; }
	};
	const element = make("div", { class: "number" }, make("label", { for: id }, label), slider, field, tick, ends, safe, fair);
	return { element, update: (doc) => show(get(doc, path)), mark, warn };
}

function vectorControl(c, act) {
	const parts = ["x", "y", "z"].map((axis, i) => numberControl(c, act, `${c.label} ${axis}`, [...c.path, i]));
	return { element: make("details", {}, make("summary", {}, c.label), ...parts.map((p) => p.element)), update: (doc) => parts.forEach((p) => p.update(doc)), warn: (fair, doc) => parts.forEach((p) => p.warn(fair, doc)) };
}

function textControl(c, act) {
	const id = `c-${c.path.join("-")}`, field = make("input", { type: "text", id, autocomplete: "off", spellcheck: "false" });
	field.addEventListener("change", () => { if (field.value !== get(act.document(), c.path)) { act.move(c.path, field.value, true); act.commit(); } });
	return { element: make("div", { class: "choice" }, make("label", { for: id }, c.label), field), update: (doc) => { if (!field.matches(":focus")) field.value = get(doc, c.path) ?? ""; } };
}

function choiceControl(c, act) {
	const id = `c-${c.path.join("-")}`, select = make("select", { id }, ...c.options.map(([, name], i) => make("option", { value: i }, name)));
	select.addEventListener("change", () => { const value = c.options[select.value][0]; act.move(c.path, value === null ? undefined : value, true, (doc) => (c.frees || []).reduce((d, path) => (get(d, path) ? put(d, path, undefined) : d), doc)); act.commit(); });
	return { element: make("div", { class: "choice" }, make("label", { for: id }, c.label), select), update: (doc) => { const v = get(doc, c.path) ?? null; select.value = Math.max(0, c.options.findIndex(([o]) => String(o) === String(v))); } };
}

export const KINDS = ["near", "through", "inside", "outside"];
const MEANING = { near: "pass close by", through: "pass exactly through, a handle of the surface", inside: "keep inside", outside: "keep outside" };

function pointsControl(c, act) {
	const list = make("div", { class: "points" }), kind = make("select", { "aria-label": "kind of the new point" }, ...KINDS.map((k) => make("option", { value: k, title: MEANING[k] }, k)));
	const add = make("button", { type: "button", onclick: () => act.addPoint(kind.value) }, "Add point");
	const weight = numberControl({ group: "Points", label: "weight of near", low: 0, high: 1000, usual: "100", bent: 2 }, act, "weight of near", [...c.path, "near_weight"]);
	let shape = "", rows = [];
	const update = (doc) => {
		const held = get(doc, c.path) || {}, now = KINDS.map((k) => (held[k] || []).length).join();
		if (now !== shape) {
			shape = now; rows = [];
			list.replaceChildren(...KINDS.flatMap((k) => (held[k] || []).map((_, i) => {
				const parts = ["x", "y", "z"].map((axis, j) => numberControl({ group: `Point ${k} ${i + 1}`, label: axis, ...act.room(j) }, act, axis, [...c.path, k, i, j]));
				rows.push(...parts);
				return make("fieldset", {}, make("legend", {}, `${k} ${i + 1} `, make("button", { type: "button", class: "small", "aria-label": `remove the point ${k} ${i + 1}`, onclick: () => { act.move([...c.path, k], held2(k).filter((_, n) => n !== i), true); act.commit(); } }, "✕")), ...parts.map((p) => p.element));
			})));
		}
		rows.forEach((r) => r.update(doc)); weight.element.hidden = !(held.near || []).length; weight.update(doc);
	};
	const held2 = (k) => get(act.document(), c.path)?.[k] || [];
	return { element: make("div", {}, make("div", { class: "row" }, kind, add), list, weight.element), update };
}

// By which the surface is pulled: of single cells B-coefficients that are held, and else points to pass through.
function handlesControl(c, act) {
	const list = make("div", { class: "points" }), add = make("button", { type: "button", title: "next to the place that was clicked last, or to the middle of the picture", onclick: () => (c.through ? act.addPoint("through", 7) : act.addHandle()) }, "Add handle");
	let shape = "", rows = [];
	const held = (doc) => get(doc, c.path) || [];
	const update = (doc) => {
		const now = JSON.stringify(held(doc).map(([at]) => at));
		if (now !== shape) {
			shape = now;
			rows = held(doc).map(([[cell, index], value], i) => numberControl({ group: `Handle ${i + 1}`, label: `handle ${i + 1}`, ...act.span([cell, index], number(value)) }, act, `handle ${i + 1}`, [...c.path, i, 1]));
			list.replaceChildren(...rows.map((r, i) => make("div", { class: "held", title: `B-coefficient of cell ${held(doc)[i][0][0]}, (${held(doc)[i][0][1].join(", ")})` }, r.element, make("button", { type: "button", class: "small", "aria-label": `remove handle ${i + 1}`, onclick: () => { act.move(c.path, held(act.document()).filter((_, n) => n !== i), true); act.commit(); } }, "✕"))));
		}
		rows.forEach((r) => r.update(doc));
	};
	return { element: make("div", {}, make("div", { class: "row" }, add), list), update };
}

// Coefficients of members: those that are not held follow by energy, and are shown as they came out.
function coefficientsControl(c, act) {
	const fixed = { ...act, move: (path, value, settled) => act.move(path, value, settled, act.atDegree) };
	const rows = c.names.map((name, i) => {
		const about = { group: "Coefficients", label: `of member ${i + 1}`, low: c.ends[i][0], high: c.ends[i][1], usual: "0" }, path = [...c.path, String(i)], row = numberControl(about, fixed, `a${i + 1}`, path);
		const free = make("button", { type: "button", class: "small", "aria-label": `let coefficient ${i + 1} follow`, title: "let it follow the others", onclick: () => { act.move(path, undefined, true); act.commit(); } }, "free");
		const element = make("div", { class: "held", title: name }, row.element, free);
		return { element, settle: (value) => { about.usual = String(Number(value.toPrecision(4))); }, update: (doc) => { free.classList.toggle("off", get(doc, path) === undefined); row.update(doc); } };
	});
	return { element: make("div", {}, ...rows.map((r) => r.element)), settle: (values) => rows.forEach((r, i) => r.settle(values[i])), update: (doc) => rows.forEach((r) => r.update(doc)) };
}

const MAKERS = { number: numberControl, vector: vectorControl, choice: choiceControl, text: textControl, points: pointsControl, handles: handlesControl, coefficients: coefficientsControl };

// All controls, in their groups; what is there already stays, so that no field is taken from under the fingers.
export class Panel {
	constructor(place, act) { this.place = place; this.act = act; this.made = ""; this.controls = []; this.open = new Map(); }
	show(list, doc, members = []) { // `members` are the coefficients of the last shape
		const made = JSON.stringify(list);
		if (made !== this.made) {
			this.made = made; this.controls = list.map((c) => MAKERS[c.kind](c, this.act));
			const groups = new Map();
			list.forEach((c, i) => groups.set(c.group, [...(groups.get(c.group) || []), this.controls[i].element]));
			this.place.replaceChildren(...[...groups].map(([name, inside]) => {
				const d = make("details", { class: "group", open: this.open.get(name) ?? true }, make("summary", {}, name), ...inside);
				d.addEventListener("toggle", () => this.open.set(name, d.open));
				return d;
			}));
		}
		this.controls.forEach((c) => c.settle?.(members));
		this.update(doc);
	}
	warn(fair, doc) { this.controls.forEach((c) => c.warn?.(fair, doc)); }
	mark(limits) { this.controls.forEach((c) => c.mark?.(limits)); }
	update(doc) { this.controls.forEach((c) => c.update(doc)); }
}
