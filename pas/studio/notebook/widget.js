// The studio in a notebook (anywidget): one request is on its way at a time, and only the newest move waits.  A widget that
// is shown twice has two views, each with answers of its own; the document is that of all.
import { array } from "./scene.js";
import { render } from "./studio.js";

export default {
	render({ model, el }) {
		let flying = 0, next = null;
		const me = Math.random().toString(36).slice(2);
		const listeners = [], place = el.appendChild(document.createElement("div"));
		place.style.height = "620px";
		const post = (request) => { flying = request.do === "move" || request.do === "rest" ? request.seq : flying; model.send({ ...request, view: me }); };
		const channel = {
			send: (request) => { if (request.do === "move" && flying) next = request; else { if (request.do === "rest") next = null; post(request); } },
			receive: (f) => listeners.push(f),
		};
		const heard = (head, buffers) => {
			if (head.view !== me) return;
			const arrays = {};
			head.arrays.forEach(([name, type, n], i) => { const b = buffers[i], view = b.buffer ? b : new DataView(b); arrays[name] = array(view.buffer.slice(view.byteOffset, view.byteOffset + view.byteLength), type, 0, n); });
			if (head.seq >= flying) { flying = 0; if (next) { const request = next; next = null; post(request); } }
			listeners.forEach((f) => f(head, arrays));
		};
		const keep = (doc) => { model.set("document", doc); model.save_changes(); };
		const made = render({ channel, el: place, start: model.get("document"), keep });
		place.addEventListener("keydown", (e) => { // what the studio took and plain keys are not the notebook's, where a letter may delete a cell
			if (e.defaultPrevented || !(e.ctrlKey || e.metaKey || e.altKey || (e.shiftKey && e.key === "Enter"))) e.stopPropagation();
		});
		const changed = () => { if (JSON.stringify(model.get("document")) !== JSON.stringify(made.state.doc)) made.openDocument(model.get("document"), false); };
		model.on("msg:custom", heard); model.on("change:document", changed); made.go(model.get("document"));
		return () => { model.off("msg:custom", heard); model.off("change:document", changed); made.destroy(); };
	},
};
