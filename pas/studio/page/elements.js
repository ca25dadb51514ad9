// The elements of the page: the picture with its bar, and beside it what is said of the shape and what can be done.
import { make, svg } from "./controls.js";
import { MODES } from "./looks.js";
import { VIEWS } from "./view.js";

export const options = (names) => names.map((name) => make("option", {}, name));

// Fills `el`; what is pressed and chosen calls the functions of `on`.  Returns the elements by name.
export function elements(el, on) {
	const $ = {};
	const button = (name, label, act, more = {}) => ($[name] = make("button", { type: "button", onclick: act, ...more }, label));
	const row = (...inside) => make("div", { class: "row" }, ...inside), section = (title, ...inside) => make("section", {}, make("h2", {}, title), ...inside);
	el.classList.add("pas-studio");
	el.replaceChildren(
		($.main = make("main", {},
			($.bar = make("div", { class: "bar", role: "toolbar", "aria-label": "Picture" },
				make("div", { class: "group" }, ...Object.entries(MODES).map(([mode, label]) => button(mode, label, () => on.mode(mode), { "aria-pressed": String(mode === "shaded") }))),
				($.views = make("select", { "aria-label": "View", onchange: () => { on.view($.views.value); $.views.selectedIndex = 0; } }, make("option", { value: "" }, "View"), ...options(Object.keys(VIEWS)))),
				make("div", { class: "group" }, button("cut", "Section", () => on.toggle("cut"), { "aria-pressed": "false" }), button("wire", "Cells", () => on.toggle("wire"), { "aria-pressed": "false" }), button("combs", "Combs", () => on.toggle("combs"), { "aria-pressed": "false" })),
			)),
			($.place = make("div", { class: "place" })),
			($.marks = svg("svg", { class: "marks" })),
			($.legend = make("div", { class: "legend", hidden: true })),
			($.cutting = make("div", { class: "cutting", hidden: true },
				($.cutAxis = make("select", { "aria-label": "Section plane across", onchange: () => on.section() }, ...options(["x", "y", "z"]))),
				($.cutAt = make("input", { type: "range", min: -100, max: 100, value: 0, "aria-label": "Section plane at", oninput: () => on.section() })))),
			($.message = make("div", { class: "message", role: "status", "aria-live": "polite" }, "starting …")),
		)),
		($.side = make("aside", { "aria-label": "Shape" },
			make("header", {}, ($.title = make("h1", {}, "Studio")), ($.gallery = make("select", { "aria-label": "Starting points", hidden: true, onchange: () => on.start($.gallery.value) }))),
			row(button("undo", "Undo", () => on.undo(), { title: "Ctrl+Z" }), button("redo", "Redo", () => on.redo(), { title: "Ctrl+Y" }),
				button("open", "Open …", () => $.file.click()), ($.file = make("input", { type: "file", hidden: true, accept: ".toml,.json", onchange: () => { if ($.file.files[0]) on.file($.file.files[0]); $.file.value = ""; } }))),
			make("section", {}, make("h2", {}, "Proof ", ($.overall = make("span", { class: "overall" }))), ($.unfair = make("div", { class: "warning", role: "alert", hidden: true }, ($.reasons = make("span", {})), button("fairer", "Back to the last fair", () => on.fairer(), { class: "small" }))), ($.lamps = make("ul", { class: "lamps" })),
				($.help = make("div", { class: "row", hidden: true }, button("repair", "Repair", () => on.repair()), button("back", "Back to the last proved", () => on.back())))),
			($.measured = make("section", { hidden: true }, make("h2", {}, "Fairness ", ($.measuring = make("span", { class: "told" }))), ($.fairness = make("dl", {})))),
			($.curve = make("section", { hidden: true }, make("h2", {}, "Curvature along a curve "), ($.curves = make("select", { "aria-label": "Curve", onchange: () => on.curve() })), ($.diagram = make("div", { class: "diagram" })))),
			section("Shape", ($.parts = make("ul", { class: "parts", "aria-label": "Parts" })), ($.controls = make("div", {}))),
			section("The same in code", row(button("python", "Copy as Python", () => on.copy("python")), button("toml", "Copy as TOML", () => on.copy("toml"))), ($.code = make("pre", { tabindex: 0, "aria-label": "Python" }))),
			section("Save", row(($.format = make("select", { "aria-label": "Format" }, ...options([".pas.json"]))), button("export", "Export", () => on.export()), button("png", "PNG", () => on.png()), button("film", "Turntable", () => on.film(), { title: "one turn as a WebM film" }), ($.pixels = make("select", { "aria-label": "Size of the PNG" }, ...options(["1200 x 900", "1920 x 1080", "3840 x 2160", "600 x 450"]))))),
		)),
	);
	return $;
}
