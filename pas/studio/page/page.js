// The page of `pas studio`: it talks to its own server, and again when that was lost.
import { render } from "./studio.js";
import { unpacked } from "./scene.js";

const KEY = "pas token", PATIENCE = [300, 700, 1500, 3000];

function opening() { // the token is taken out of the address at once; the state stays there
	const given = new URLSearchParams(location.hash.slice(1)), token = given.get("token") || sessionStorage.getItem(KEY) || "";
	if (token) sessionStorage.setItem(KEY, token);
	let start = null;
	try { start = given.has("state") ? JSON.parse(given.get("state")) : null; } catch { /* not a state: begin anew */ }
	history.replaceState(null, "", location.pathname + (start ? `#state=${encodeURIComponent(JSON.stringify(start))}` : ""));
	return { token, start };
}

const { token, start } = opening(), listeners = [], states = [], waiting = [];
let socket = null, tries = 0, ended = false;

function connect() {
	socket = new WebSocket(`ws://${location.host}/talk`, token ? ["pas", token] : ["pas"]);
	socket.binaryType = "arraybuffer";
	socket.onopen = () => { const again = tries > 0 || socket.again; tries = 0; if (again) states.forEach((f) => f("connected again", true)); while (waiting.length) socket.send(waiting.shift()); };
	socket.onmessage = (e) => { const { head, arrays } = unpacked(e.data); listeners.forEach((f) => f(head, arrays)); };
	socket.onclose = (e) => {
		if (ended) return;
		if (e.code === 4429) { states.forEach((f) => f("There are too many pages of this studio; close another one and load this one again.")); return; }
		if (tries >= 3 && !document.hidden && !globalThis.studio?.state?.scene) { states.forEach((f) => f("The studio does not answer; open the address that `pas studio` printed.")); }
		else states.forEach((f) => f("The connection is lost; trying again …"));
		setTimeout(connect, PATIENCE[Math.min(tries++, PATIENCE.length - 1)]);
	};
}

const channel = {
	send: (request) => { const text = JSON.stringify(request); if (socket?.readyState === WebSocket.OPEN) socket.send(text); else if (request.do !== "move" && waiting.length < 4) waiting.push(text); },
	receive: (f) => listeners.push(f),
	onstate: (f) => states.push(f),
};
const keep = (doc) => history.replaceState(null, "", `${location.pathname}#state=${encodeURIComponent(JSON.stringify(doc))}`);
globalThis.studio = render({ channel, el: document.getElementById("studio"), start, keep });
addEventListener("pagehide", () => { ended = true; socket?.close(); });
connect();
