// The page of `pas studio`: it talks to its own server, and again when that was lost.
import { render } from "./studio.js";
import { unpacked } from "./scene.js";

const KEY = "pas token", PATIENCE = [300, 700, 1500, 3000];
const LOST = "The connection is lost; trying again …", SILENT = "`pas studio` does not answer: the connection is lost, or it has ended; trying again …";
const UNKNOWN = "The studio does not know this page: open the address that `pas studio` printed, with its token, once in this browser.";

function opening() { // the token is taken out of the address at once, and kept for the other tabs of this server; the state stays there
	const given = new URLSearchParams(location.hash.slice(1));
	if (given.get("token")) localStorage.setItem(KEY, given.get("token"));
	let start = null;
	try { start = given.has("state") ? JSON.parse(given.get("state")) : null; } catch { /* not a state: begin anew */ }
	history.replaceState(null, "", location.pathname + (start ? `#state=${encodeURIComponent(JSON.stringify(start))}` : ""));
	return start;
}

const start = opening(), listeners = [], states = [], waiting = [];
let socket = null, tries = 0, ended = false;

function connect() {
	const token = localStorage.getItem(KEY); // another tab may have a newer one
	if (!token) { again(UNKNOWN); return; }
	let opened = false;
	socket = new WebSocket(`ws://${location.host}/talk`, ["pas", token]);
	socket.binaryType = "arraybuffer";
	socket.onopen = () => { opened = true; const back = tries > 0; tries = 0; if (back) states.forEach((f) => f("connected again", true)); while (waiting.length) socket.send(waiting.shift()); };
	socket.onmessage = (e) => { const { head, arrays } = unpacked(e.data); listeners.forEach((f) => f(head, arrays)); };
	socket.onclose = (e) => {
		if (ended) return;
		if (e.code === 4429) { states.forEach((f) => f("There are too many pages of this studio; close another one and load this one again.")); return; }
		if (opened) again(LOST); else refused().then((is) => again(is ? UNKNOWN : SILENT));
	};
}
function again(text) { states.forEach((f) => f(text)); setTimeout(connect, PATIENCE[Math.min(tries++, PATIENCE.length - 1)]); }
const refused = () => fetch("index.html", { method: "HEAD" }).then((answer) => answer.ok, () => false); // it is there, but does not talk to this page

const channel = {
	send: (request) => { const text = JSON.stringify(request); if (socket?.readyState === WebSocket.OPEN) socket.send(text); else if (request.do !== "move" && waiting.length < 4) waiting.push(text); },
	receive: (f) => listeners.push(f),
	onstate: (f) => states.push(f),
};
const keep = (doc) => history.replaceState(null, "", `${location.pathname}#state=${encodeURIComponent(JSON.stringify(doc))}`);
globalThis.studio = render({ channel, el: document.getElementById("studio"), start, keep });
addEventListener("pagehide", () => { ended = true; socket?.close(); });
connect();
