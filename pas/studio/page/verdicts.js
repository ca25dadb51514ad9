// What is said of the picture that is seen: the verdicts of its proof, and how fair it is.
import { make } from "./controls.js";
import { same, short } from "./values.js";

const SIGNS = { proved: "✓", refuted: "✗", undecided: "?", "holds, measured": "≈", "fails, measured": "✗", checking: "…" };
const MEASURES = { sharpness: "sharpness", hollowness: "hollowness", bulge: "bulge", wrong_sign: "wrong sign", waist: "waist" };

// Of a studio { s, $, view, panel, say, overlay }: `stale` where another state is asked for, `judge` and `measures` with
// what comes of it, `settled` with every picture.
export function verdictsOf({ s, $, view, panel, say, overlay }) {
	function stale() {
		$.overall.textContent = "checking"; $.overall.className = "overall checking"; $.help.hidden = true; settled();
		for (const l of $.lamps.children) { l.className = "checking"; l.firstChild.replaceChildren(SIGNS.checking, make("span", { class: "unseen" }, " checking ")); }
	}
	function judge(head) {
		s.judged = head;
		$.lamps.replaceChildren(...[...head.verdicts].sort((a, b) => (a.status === "proved") - (b.status === "proved")).map((v) => {
			const state = v.status.split(",")[0], l = make("li", { class: v.status === "holds, measured" ? "measured" : state, title: v.reason }, make("b", {}, SIGNS[v.status] || "?", make("span", { class: v.status === "proved" ? "unseen" : "" }, ` ${v.status} `)), make("span", {}, v.claim));
			if (v.witness) l.append(make("button", { type: "button", class: "small", onclick: () => { const p = s.scene.local(v.witness); view.aim(p.some((x) => Math.abs(x) > 1e-9) ? p : [1, -1, 1]); say(`${v.claim}: ${v.reason}`); } }, "Show"));
			return l;
		}));
		const bad = head.verdicts.some((v) => v.status === "refuted"), word = head.proved ? "all proved" : bad ? "refuted" : head.counts;
		$.overall.textContent = `${head.proved ? SIGNS.proved : bad ? SIGNS.refuted : SIGNS.undecided} ${word}`;
		$.overall.className = `overall ${head.proved ? "proved" : bad ? "refuted" : "undecided"}`;
		$.help.hidden = !bad; $.back.disabled = !s.lastProved;
		settled(); overlay();
	}
	// How fair is what is seen: said as long as it is seen, and "being measured" once another picture is.
	function measures({ shot, facts, unfair = [] }) {
		if (shot !== s.shot) return;
		const f = facts.fairness, limits = facts.limits || {};
		s.measured = shot; s.unfair = unfair; s.known = Boolean(f); settled();
		$.measured.hidden = !f; if (!f) return;
		$.fairness.replaceChildren(...Object.entries(MEASURES).flatMap(([key, label]) => {
			const value = f[key], most = limits[key], high = most !== undefined && value > most;
			const none = key === "hollowness" && !f.arc;
			return [make("dt", {}, label), make("dd", { class: high ? "high" : "" }, none ? "none" : `${short(value)}${most === undefined || most > 100 ? "" : ` / ${short(most)}`}${high ? " ▲" : ""}`)];
		}));
	}

	// Takes what is proved and fair for the last such state: its values are marked on the sliders that have left it.
	function settled() {
		const now = s.measured === s.shot, doc = s.asked.get(s.shown);
		if (now && s.known && !s.unfair.length && s.judged?.proved && s.judged.shot === s.shot) s.fair = doc;
		s.beyond = now && s.unfair.length > 0;
		const said = s.beyond ? "undecided" : now && s.shown === s.seq ? "proved" : "checking"; // what is fair is said of the newest state alone
		$.fairness.classList.toggle("old", said === "checking"); $.measuring.textContent = { undecided: "▲ not fair", proved: s.known ? "✓ fair" : "", checking: "being measured …" }[said]; $.measuring.className = `told ${said}`;
		$.unfair.hidden = !s.beyond; $.reasons.textContent = s.beyond ? `▲ not fair: ${s.unfair.join("; ")} ` : ""; $.fairer.hidden = !s.fair || same(s.fair, doc);
		marked();
	}
	function marked() { panel.warn(s.fair && (s.beyond || s.judged?.verdicts.some((v) => v.status === "refuted")) ? s.fair : null, s.doc); }
	return { stale, judge, measures, settled };
}
