// src/dom.ts
/** An element with attributes (functions are listeners: `onclick`) and children. */
function h(tag, attributes = {}, ...children) {
	const element = document.createElement(tag);
	for (const [name, value] of Object.entries(attributes)) if (typeof value === "function") element.addEventListener(name.slice(2), value);
	else if (value === true) element.setAttribute(name, "");
	else if (value !== false && value !== null && value !== void 0) element.setAttribute(name, String(value));
	element.append(...children.filter((c) => c !== null));
	return element;
}
/** Sets a property only where it changes, so that nothing under the user's hands is disturbed. */
function setText(element, text) {
	if (element.textContent !== text) element.textContent = text;
}
/** Sets what a field shows, unless the user is typing there or holds it. */
function setValue(field, value) {
	if (field.dataset.editing === void 0 && field.value !== value) field.value = value;
}
/** Keeps track of the field that is being edited. */
function trackEditing() {
	const ends = ({ target }) => target instanceof HTMLElement && delete target.dataset.editing;
	document.addEventListener("input", ({ target }) => target instanceof HTMLInputElement && (target.dataset.editing = ""), true);
	document.addEventListener("change", ends, true);
	document.addEventListener("focusout", ends, true);
}
/** What choices have. */
var shownOptions = /* @__PURE__ */ new WeakMap();
/** The options of a choice; the same ones are kept. */
function setOptions(select, options) {
	const key = JSON.stringify(options);
	if (shownOptions.get(select) === key) return;
	shownOptions.set(select, key);
	select.replaceChildren(...options.map((o) => h("option", {
		value: o.value,
		title: o.title
	}, o.text ?? o.value)));
}
/** Whether a button that stays pressed is. */
var isPressed = (button) => button.getAttribute("aria-pressed") === "true";
var setPressed = (button, on) => button.setAttribute("aria-pressed", String(on));
/** A section that folds. */
function section(title, open, ...children) {
	return h("details", {
		class: "section",
		open
	}, h("summary", {}, h("h2", {}, title)), h("div", { class: "body" }, ...children));
}
/** A field with its label at the left. */
function row(label, field, title) {
	return h("label", {
		class: "row",
		title
	}, h("span", {}, label), field);
}
/** A number for people: about four digits. */
function show(v) {
	if (!Number.isFinite(v)) return String(v);
	const a = Math.abs(v);
	if (a === 0) return "0";
	return a >= 1e6 || a < .001 ? Number(v.toPrecision(3)).toExponential() : String(Number(v.toPrecision(4)));
}
// src/keys.ts
/** Keys, and the page that lists them. */
/** What the pointer does, for the list. */
var POINTER = [
	["Drag, middle drag", "orbit"],
	["Shift + drag", "pan the camera"],
	["Wheel", "dolly"],
	["Ctrl + wheel", "zoom the picture"],
	["Ctrl + drag", "move the picture"],
	["Click", "pin a pixel, select the object"],
	["One finger", "orbit"],
	["Two fingers", "pan and dolly"],
	["W A S D Q E, mouse", "fly, once started; Shift is faster, the wheel changes the speed, Escape ends"]
];
/** A plain key, by the character it writes. */
var character = (...keys) => (event) => !event.ctrlKey && !event.metaKey && !event.altKey && keys.includes(event.key);
/** A key by its place, whatever else is held but Alt. */
var place$1 = (...codes) => (event) => !event.altKey && codes.includes(event.code);
/** Whether what has the focus wants the keys for itself. */
function isTyping(target) {
	if (target instanceof HTMLInputElement) return ![
		"checkbox",
		"range",
		"color"
	].includes(target.type);
	return target instanceof HTMLSelectElement || target instanceof HTMLTextAreaElement;
}
var Keys = class {
	keys;
	help;
	constructor(keys) {
		this.keys = keys;
		const rows = (list) => list.map(([key, doc]) => h("div", {}, h("dt", {}, h("kbd", {}, key)), h("dd", {}, doc)));
		const groups = [
			"Picture",
			"Camera",
			"Render"
		].map((group) => {
			const list = keys.filter((k) => k.group === group).map((k) => [k.shown, k.doc]);
			return h("section", {}, h("h3", {}, group), h("dl", {}, ...rows(list)));
		});
		const close = h("button", {
			onclick: () => this.help.close(),
			"aria-label": "Close"
		}, "Close");
		this.help = h("dialog", {
			class: "help",
			"aria-labelledby": "help-title"
		}, h("header", {}, h("h2", { id: "help-title" }, "Keys and pointer"), close), h("div", { class: "columns" }, h("section", {}, h("h3", {}, "Pointer"), h("dl", {}, ...rows(POINTER))), ...groups));
		this.help.addEventListener("click", (event) => event.target === this.help && this.help.close());
		addEventListener("keydown", (event) => this.press(event));
	}
	toggle() {
		if (this.help.open) this.help.close();
		else this.help.showModal();
	}
	press(event) {
		if (event.defaultPrevented || isTyping(event.target) || this.help.open && event.key !== "?") return;
		if (event.target instanceof HTMLInputElement && /^(Arrow|Page|Home|End)/.test(event.key)) return;
		const key = this.keys.find((k) => k.is(event));
		if (!key) return;
		event.preventDefault();
		key.act(event);
	}
};
// src/bindings.ts
/** CSS pixels of a drag that an arrow key stands for. */
var STEP = 20;
function bindings({ view, camera, toolbar, look, compare, inspector, pick, selection, path, focus, move, from, fly, send, help }) {
	const zoom = (factor) => {
		view.placement.zoom(factor);
		view.redraw();
	};
	const side = (code, shown, of) => ({
		shown,
		doc: `from the ${of}; with Ctrl from the opposite side`,
		group: "Camera",
		is: place$1(code),
		act: (e) => from(of, e.ctrlKey)
	});
	const history = (shown, type, is) => ({
		shown,
		doc: type,
		group: "Render",
		is,
		act: () => send({ type })
	});
	const isZ = (event) => (event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "z";
	return [
		side("Numpad1", "Numpad 1", "front"),
		side("Numpad3", "Numpad 3", "right"),
		side("Numpad7", "Numpad 7", "top"),
		{
			shown: "[  ]",
			doc: "exposure by half an EV",
			group: "Picture",
			is: character("[", "]"),
			act: (e) => look.expose(view.tone.exposure + (e.key === "[" ? -.5 : .5))
		},
		{
			shown: "\\",
			doc: "exposure 0",
			group: "Picture",
			is: character("\\"),
			act: () => look.expose(0)
		},
		{
			shown: "+  −",
			doc: "zoom",
			group: "Picture",
			is: character("+", "=", "-"),
			act: (e) => zoom(e.key === "-" ? 1 / 1.5 : 1.5)
		},
		{
			shown: "F",
			doc: "fit the picture into the window",
			group: "Picture",
			is: character("f"),
			act: () => (view.placement.fit(), view.redraw())
		},
		{
			shown: "1",
			doc: "one pixel for each pixel",
			group: "Picture",
			is: character("1"),
			act: () => (view.placement.actual(), view.redraw())
		},
		{
			shown: "C",
			doc: "false colour",
			group: "Picture",
			is: character("c"),
			act: () => look.setFalse(!view.isFalse)
		},
		{
			shown: "L",
			doc: "next layer; with Shift the one before",
			group: "Picture",
			is: character("l", "L"),
			act: (e) => look.stepLayer(e.shiftKey ? -1 : 1)
		},
		{
			shown: "B",
			doc: "picture A or B, the one it is compared with",
			group: "Picture",
			is: character("b"),
			act: () => compare.alternate()
		},
		{
			shown: "T",
			doc: "draw the path of a sample of the pinned pixel",
			group: "Picture",
			is: character("t"),
			act: () => path.toggle()
		},
		{
			shown: "N",
			doc: "show or hide the panel",
			group: "Picture",
			is: character("n"),
			act: () => toolbar.press("panel")
		},
		{
			shown: "?",
			doc: "this list",
			group: "Picture",
			is: character("?"),
			act: help
		},
		{
			shown: "Arrows",
			doc: "orbit; with Shift pan",
			group: "Camera",
			is: place$1("ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown"),
			act: ({ code, shiftKey }) => {
				const [dx, dy] = {
					ArrowLeft: [-20, 0],
					ArrowRight: [STEP, 0],
					ArrowUp: [0, -20],
					ArrowDown: [0, STEP]
				}[code];
				move(() => shiftKey ? camera.pan(dx, dy, view.canvas.clientHeight) : camera.orbit(dx, dy));
			}
		},
		{
			shown: "Page up, down",
			doc: "dolly",
			group: "Camera",
			is: place$1("PageUp", "PageDown"),
			act: (e) => move(() => camera.dolly(e.code === "PageUp" ? .9 : 1 / .9))
		},
		{
			shown: ".",
			doc: "turn to the point under the pointer, and about it; with Shift focus there",
			group: "Camera",
			is: place$1("Period", "NumpadDecimal"),
			act: (e) => e.shiftKey ? focus() : void pick.center()
		},
		{
			shown: "Shift + `",
			doc: "fly",
			group: "Camera",
			is: (e) => e.shiftKey && e.code === "Backquote",
			act: fly
		},
		{
			shown: "Home",
			doc: "back to the scene’s camera",
			group: "Camera",
			is: place$1("Home"),
			act: () => send({ type: "camera-reset" })
		},
		{
			shown: "R",
			doc: "frame a region to render",
			group: "Render",
			is: character("r"),
			act: () => toolbar.setRegion(!toolbar.region)
		},
		{
			shown: "P",
			doc: "pause, go on",
			group: "Render",
			is: character("p"),
			act: () => toolbar.press("pause")
		},
		history("Ctrl + Z", "undo", (e) => isZ(e) && !e.shiftKey),
		history("Ctrl + Shift + Z", "redo", (e) => isZ(e) && e.shiftKey || e.ctrlKey && e.key === "y"),
		{
			shown: "Escape",
			doc: "put the tool down, unpin the pixel, select nothing",
			group: "Render",
			is: place$1("Escape"),
			act: () => toolbar.region ? toolbar.setRegion(false) : (inspector.set(null), selection.set(null))
		}
	];
}
// src/tile.ts
var MAGIC = 1414681683;
var HEADER = 24;
/** The tile in a binary message, or `null` where it isn't one. */
function parseTile(buffer) {
	if (buffer.byteLength < HEADER) return null;
	const view = new DataView(buffer);
	if (view.getUint32(0, true) !== MAGIC) return null;
	const short = (at) => view.getUint16(at, true);
	const tile = {
		generation: view.getUint32(4, true),
		layer: short(8),
		components: short(10),
		frameWidth: short(12),
		frameHeight: short(14),
		x: short(16),
		y: short(18),
		width: short(20),
		height: short(22)
	};
	const count = tile.width * tile.height * tile.components;
	const whole = buffer.byteLength === HEADER + 2 * count && (tile.components === 1 || tile.components === 3);
	const inside = tile.x + tile.width <= tile.frameWidth && tile.y + tile.height <= tile.frameHeight;
	return whole && inside && count > 0 ? {
		...tile,
		halves: new Uint16Array(buffer, HEADER, count)
	} : null;
}
// src/socket.ts
var FIRST_PAUSE = .5;
var LONGEST_PAUSE = 10;
var Socket = class {
	listeners;
	socket = null;
	pause = FIRST_PAUSE;
	timer = 0;
	/** Requests without an answer yet. */
	asked = 0;
	constructor(listeners) {
		this.listeners = listeners;
		this.connect();
		addEventListener("online", () => this.retry());
	}
	/** Whether the last state knows of all that was asked for. */
	get isSettled() {
		return this.asked === 0;
	}
	/** Sends, or forgets it when there is no connection: the state that comes after connecting tells what holds. */
	send(message) {
		if (this.socket?.readyState !== WebSocket.OPEN) return false;
		this.asked++;
		this.socket.send(JSON.stringify(message));
		return true;
	}
	/** Tries now, when waiting. */
	retry() {
		if (this.timer === 0) return;
		clearTimeout(this.timer);
		this.connect();
	}
	take(message) {
		if (message.type !== "answered") this.listeners.message(message);
		else if (--this.asked === 0) this.listeners.settled();
	}
	connect() {
		this.timer = 0;
		const url = new URL("./api/socket", location.href);
		url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
		const socket = new WebSocket(url);
		socket.binaryType = "arraybuffer";
		socket.onopen = () => {
			this.pause = FIRST_PAUSE;
			this.asked = 0;
			this.listeners.status(true, null);
		};
		socket.onmessage = ({ data }) => {
			if (data instanceof ArrayBuffer) {
				const tile = parseTile(data);
				if (tile) this.listeners.tile(tile);
			} else this.take(JSON.parse(data));
		};
		socket.onclose = () => {
			this.listeners.status(false, this.pause);
			this.timer = window.setTimeout(() => this.connect(), 1e3 * this.pause);
			this.pause = Math.min(2 * this.pause, LONGEST_PAUSE);
		};
		this.socket = socket;
	}
};
// src/status.ts
/** The line below the picture: how far the render is, and whether the server is there. */
var Status = class {
	element = h("footer", { class: "status" });
	dot = h("span", {
		class: "dot",
		"aria-hidden": "true"
	});
	connection = h("span", { role: "status" }, "connecting");
	facts = h("span", { class: "status-facts" });
	progress = h("progress", {
		max: 1,
		value: 0,
		"aria-label": "Samples taken"
	});
	retry;
	state = null;
	frame = null;
	constructor(retry) {
		this.retry = h("button", {
			class: "small",
			hidden: true,
			onclick: retry
		}, "Try now");
		this.element.append(this.dot, this.connection, this.retry, this.facts, this.progress);
	}
	connected(on, seconds) {
		this.element.classList.toggle("lost", !on);
		this.retry.hidden = on;
		setText(this.connection, on ? "" : `connection lost; next try in ${seconds} s`);
	}
	update(state, frame) {
		this.state = state ?? this.state;
		this.frame = frame ?? this.frame;
		const { settings, paused } = this.state ?? {};
		const f = this.frame;
		const what = f === null ? "no picture yet" : paused ? "paused" : f.kind === "preview" ? "preview" : f.done ? "done" : "rendering";
		this.element.dataset.what = what;
		const parts = [what, settings?.integrator];
		if (f) {
			const isCounted = f.kind === "render" || f.samples < f.target;
			parts.push(isCounted ? `${show(f.samples)} / ${f.target} spp` : null);
			if (f.error !== null) parts.push(`error ${show(100 * f.error)} %`);
			parts.push(`${f.seconds < 10 ? f.seconds.toFixed(2) : f.seconds.toFixed(0)} s`);
			if (f.denoised) parts.push("denoised");
			if (f.nonfinite > 0) parts.push(`${f.nonfinite} not finite`);
			parts.push(`${f.width} × ${f.height}`);
			this.progress.value = Math.min(1, f.samples / Math.max(f.target, 1));
		}
		const text = parts.filter(Boolean).join(" · ");
		setText(this.facts, text);
		this.facts.title = text;
	}
};
// src/connection.ts
var Connection = class {
	status = new Status(() => this.socket?.retry());
	state = null;
	socket = null;
	isNew = true;
	/** Sends, unless there is no connection; tells whether it did. */
	send(message) {
		return this.socket?.send(message) ?? false;
	}
	/** Connects, and tells what comes. */
	open(told) {
		this.socket = new Socket({
			message: (message) => {
				if (message.type === "state") this.takeState(message, told);
				else if (message.type === "frame") {
					told.frame(message);
					this.status.update(null, message);
				} else told.other(message);
			},
			tile: (tile) => told.tile(tile),
			status: (connected, seconds) => {
				this.isNew ||= connected;
				this.status.connected(connected, seconds);
			},
			settled: () => this.state && told.fields(this.state, this.isNew)
		});
	}
	takeState(state, told) {
		const { isNew } = this;
		this.state = state;
		told.state(state, isNew);
		if (isNew || this.socket?.isSettled) told.fields(state, isNew);
		this.status.update(state, null);
		this.isNew = false;
	}
};
// src/drop.ts
/** Files dropped on the page are opened: models or scenes with what belongs to them, folders too; a picture becomes the environment map. */
var Drop = class {
	tell;
	hint = h("div", {
		class: "drop",
		hidden: true
	}, "Drop a model or a scene with what belongs to it, or an environment map");
	constructor(tell) {
		this.tell = tell;
		let depth = 0;
		const isFiles = (event) => event.dataTransfer?.types.includes("Files") ?? false;
		const show = (on) => this.hint.hidden = !on;
		addEventListener("dragenter", (event) => isFiles(event) && show(++depth > 0));
		addEventListener("dragleave", (event) => isFiles(event) && show(--depth > 0));
		addEventListener("dragover", (event) => isFiles(event) && event.preventDefault());
		addEventListener("drop", (event) => {
			if (!isFiles(event)) return;
			event.preventDefault();
			show((depth = 0) > 0);
			this.open([...event.dataTransfer.items]);
		});
	}
	async open(items) {
		try {
			const entries = items.map((item) => ({
				entry: item.webkitGetAsEntry(),
				file: item.getAsFile()
			}));
			const found = (await Promise.all(entries.map(({ entry, file }) => entry ? filesOf(entry) : file ? [{
				file,
				path: file.name
			}] : []))).flat();
			if (found.length === 0) return;
			const form = new FormData();
			for (const { file, path } of found) form.append("file", file, path);
			this.tell({
				severity: "note",
				text: `opening ${found.length === 1 ? found[0].path : `${found.length} files`}`
			});
			const response = await fetch("./api/open", {
				method: "POST",
				body: form
			});
			const answer = await response.json().catch(() => ({}));
			for (const message of answer.messages ?? []) this.tell(typeof message === "string" ? {
				severity: response.ok ? "warning" : "error",
				text: message
			} : message);
			if (answer.environment) this.tell({
				severity: "note",
				text: `${answer.environment} is the environment map now`
			});
			if (!response.ok && !answer.messages?.length) this.tell({
				severity: "error",
				text: answer.error ?? response.statusText
			});
		} catch (error) {
			this.tell({
				severity: "error",
				text: `not opened: ${String(error)}`
			});
		}
	}
};
/** All files below an entry, with their paths from what was dropped. */
async function filesOf(entry, folder = "") {
	const path = folder + entry.name;
	if (entry.isFile) return [{
		file: await new Promise((resolve, reject) => entry.file(resolve, reject)),
		path
	}];
	const reader = entry.createReader();
	const all = [];
	for (;;) {
		const some = await new Promise((resolve, reject) => reader.readEntries(resolve, reject));
		if (some.length === 0) return all;
		for (const child of some) all.push(...await filesOf(child, `${path}/`));
	}
}
// src/divider.ts
/** The line between the picture and B: dragged, or moved by keys. */
var Divider = class {
	moved;
	element;
	/** `moved` is given the part of the width that is the picture's. */
	constructor(moved) {
		this.moved = moved;
		const names = [h("span", { class: "side" }, "A"), h("span", { class: "side" }, "B")];
		this.element = h("div", {
			class: "divider",
			role: "slider",
			tabindex: 0,
			hidden: true,
			"aria-label": "Divider: A at its left, B at its right",
			"aria-orientation": "horizontal",
			"aria-valuemin": 0,
			"aria-valuemax": 100,
			onkeydown: (event) => this.press(event),
			onpointerdown: (event) => this.element.setPointerCapture(event.pointerId),
			onpointermove: (event) => this.drag(event)
		}, ...names);
		this.set(.5);
	}
	part = .5;
	set(part) {
		this.part = Math.min(Math.max(part, 0), 1);
		this.element.style.left = `${100 * this.part}%`;
		this.element.setAttribute("aria-valuenow", String(Math.round(100 * this.part)));
		this.element.setAttribute("aria-valuetext", `${Math.round(100 * this.part)} % of the width are A`);
		this.moved(this.part);
	}
	drag(event) {
		if (!this.element.hasPointerCapture(event.pointerId)) return;
		const box = this.element.parentElement.getBoundingClientRect();
		this.set((event.clientX - box.left) / box.width);
	}
	press(event) {
		const step = event.shiftKey ? .1 : .01;
		const part = {
			ArrowLeft: this.part - step,
			ArrowDown: this.part - step,
			ArrowRight: this.part + step,
			ArrowUp: this.part + step,
			PageDown: this.part - .1,
			PageUp: this.part + .1,
			Home: 0,
			End: 1
		}[event.key];
		if (part === void 0 || event.ctrlKey || event.metaKey || event.altKey) return;
		event.preventDefault();
		this.set(part);
	}
};
// src/reference.ts
/** An answer of JSON and tiles, each after its length. */
function parsePieces(buffer) {
	const view = new DataView(buffer);
	const pieces = [];
	for (let at = 0; at + 4 <= buffer.byteLength;) {
		const end = at + 4 + view.getUint32(at, true);
		pieces.push(buffer.slice(at + 4, end));
		at = end;
	}
	return {
		head: JSON.parse(new TextDecoder().decode(pieces[0])),
		tiles: pieces.slice(1).flatMap((piece) => parseTile(piece) ?? [])
	};
}
async function checked(response) {
	if (response.ok) return response;
	const body = await response.json().catch(() => ({}));
	throw new Error(body.error ?? response.statusText);
}
/** B with its tiles; `null` where there is none. */
async function fetchReference() {
	const response = await checked(await fetch("./api/reference"));
	return response.status === 204 ? null : parsePieces(await response.arrayBuffer());
}
/** Makes the shown picture B, or a file. */
async function keepReference(file) {
	const body = new FormData();
	if (file) body.append("file", file, file.name);
	await checked(await fetch(`./api/reference${file ? "" : "?from=current"}`, file ? {
		method: "POST",
		body
	} : { method: "POST" }));
}
async function clearReference() {
	await checked(await fetch("./api/reference", { method: "DELETE" }));
}
/** The map of FLIP errors of what is displayed. */
async function fetchFlip(tone, exposure) {
	const query = new URLSearchParams({
		metric: "flip",
		tone,
		exposure: String(exposure)
	});
	return parsePieces(await (await checked(await fetch(`./api/difference?${query}`))).arrayBuffer());
}
// src/flipmap.ts
var FlipMap = class {
	view;
	tone;
	told;
	isBusy = false;
	isStale = false;
	turn = 0;
	/** `told` is given the figures, or why there are none. */
	constructor(view, tone, told) {
		this.view = view;
		this.tone = tone;
		this.told = told;
	}
	/** The picture, B or how they are displayed has changed. */
	update() {
		if (this.isBusy) this.isStale = true;
		else this.ask();
	}
	/** Forgets the map, also the one that is on its way. */
	clear() {
		this.turn++;
		this.isStale = false;
		this.view.others.keep(["reference"]);
	}
	async ask() {
		this.isBusy = true;
		const { turn } = this;
		try {
			const { head, tiles } = await fetchFlip(this.tone(), this.view.tone.exposure);
			if (turn === this.turn) {
				for (const tile of tiles) this.view.others.tile("map", tile);
				this.view.others.swap(head.crop, "map");
				this.view.redraw();
				this.told(head);
			}
		} catch (error) {
			if (turn === this.turn) this.told(error instanceof Error ? error.message : String(error));
		}
		this.isBusy = false;
		if (this.isStale) {
			this.isStale = false;
			this.update();
		}
	}
};
// src/number.ts
/** Fields for numbers: one to type in, with a slider where a range is known. */
/** Wider ranges than this, from above zero, slide by their logarithm. */
var WIDE = 1e3;
/** Wider ranges than this have no slider. */
var MOST$2 = 1e4;
function numberField(options) {
	const { label, range, whole = false, unit = "", change } = options;
	const [low, high] = (options.slider ?? range ?? []).map((v) => v ?? NaN);
	const ends = low !== void 0 && high !== void 0 && low < high && high - low <= MOST$2 ? [low, high] : null;
	const isLog = ends !== null && ends[0] > 0 && ends[1] / ends[0] >= WIDE;
	const place = (v) => isLog ? Math.log(v) : v;
	const value = (p) => {
		const v = isLog ? Math.exp(p) : p;
		return whole ? Math.round(v) : Number(v.toPrecision(6));
	};
	const field = h("input", {
		type: "number",
		class: "number",
		step: whole ? 1 : "any",
		min: range && Number.isFinite(range[0]) ? range[0] : null,
		max: range && Number.isFinite(range[1]) ? range[1] : null,
		"aria-label": label,
		required: true,
		onchange: () => {
			if (field.checkValidity()) take(field.valueAsNumber, true);
			else field.reportValidity();
		}
	});
	const slider = !ends ? null : h("input", {
		type: "range",
		min: place(ends[0]),
		max: place(ends[1]),
		step: whole && !isLog ? 1 : options.step ?? (place(ends[1]) - place(ends[0])) / 500,
		"aria-label": `${label}, slider`,
		oninput: () => slide(false),
		onchange: () => slide(true)
	});
	function slide(done) {
		const v = value(Number(slider.value));
		setValue(field, String(v));
		change(v, done);
	}
	function take(v, done) {
		if (slider) setValue(slider, String(place(v)));
		change(v, done);
	}
	function set(v) {
		setValue(field, String(Number(v.toPrecision(7))));
		if (slider) setValue(slider, String(place(v)));
	}
	const element = h("span", { class: slider ? "slide" : "plain" }, slider, field, unit ? h("span", { class: "unit" }, unit) : null);
	set(options.value);
	return {
		element,
		set
	};
}
// src/tone.ts
/** Curves that the shader has; a curve's number there is its place here. */
var CURVES = [
	"none",
	"clamp",
	"equalize",
	"gamma",
	"clamp-gamma",
	"equalize-gamma",
	"reinhard",
	"aces-fit",
	"agx",
	"pbr-neutral",
	"hable"
];
/** `toneCurve(rgb)`: display values in [0, 1] of linear values after exposure. */
var TONE_GLSL = `
uniform int curve;
uniform vec2 values;     // the curve's parameters
uniform float maximum;   // the picture's largest finite component, after exposure

float srgbEncode(float x) { return x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1.0 / 2.4) - 0.055; }
vec3 srgbEncode(vec3 v) { return vec3(srgbEncode(v.r), srgbEncode(v.g), srgbEncode(v.b)); }
float luminance(vec3 v) { return 0.2126 * v.r + 0.7152 * v.g + 0.0722 * v.b; }
vec3 power(vec3 v, float gamma) { return mix(pow(max(v, 1e-38), vec3(1.0 / gamma)), vec3(0.0), equal(v, vec3(0.0))); }

vec3 acesFit(vec3 v) {
  vec3 x = min(v, 1e4);
  return min((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14), 1.0);
}

vec3 agx(vec3 v) {
  // GLSL's matrices are by columns: these are transposed rows.
  const mat3 inset = mat3(0.84247906, 0.042328242, 0.042375655, 0.0784336, 0.878468640, 0.0784336, 0.079223745, 0.07916613, 0.879143);
  const mat3 outset = mat3(1.196879, -0.05289685, -0.052971635, -0.09802088, 1.1519031, -0.09804345, -0.09902974, -0.09896118, 1.1510737);
  vec3 x = (clamp(log2(max(inset * v, 1e-10)), -12.47393, 4.026069) + 12.47393) / (4.026069 + 12.47393);
  vec3 x2 = x * x;
  vec3 x4 = x2 * x2;
  vec3 s = 15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x - 0.00232;
  return pow(clamp(outset * s, 1e-12, 1.0), vec3(2.2));
}

vec3 pbrNeutral(vec3 v) {
  const float start = 0.8 - 0.04;
  float least = min(v.r, min(v.g, v.b));
  vec3 c = v - (least < 0.08 ? least - 6.25 * least * least : 0.04);
  float peak = max(c.r, max(c.g, c.b));
  if (peak < start) return c;
  float d = 1.0 - start;
  float compressed = 1.0 - d * d / (peak + d - start);
  float mixed = 1.0 - 1.0 / (0.15 * (peak - compressed) + 1.0);
  return c * (compressed / peak) * (1.0 - mixed) + compressed * mixed;
}

vec3 hableCurve(vec3 x) {
  const float a = 0.15, b = 0.50, c = 0.10, d = 0.20, e = 0.02, f = 0.30;
  return (x * (a * x + c * b) + d * e) / (x * (a * x + b) + d * f) - e / f;
}

vec3 toneCurve(vec3 v) {
  vec3 result;
  if (curve == 0) result = srgbEncode(min(v, 1.0));
  else if (curve == 1) result = min(v / values.x, 1.0);
  else if (curve == 2) result = v / maximum;
  else if (curve == 3) result = power(min(v, 1.0), values.x);
  else if (curve == 4) result = power(min(v / values.y, 1.0), values.x);
  else if (curve == 5) result = power(min(v / maximum, 1.0), values.x);
  else if (curve == 6) {
    float l = luminance(v);
    result = srgbEncode(min(v * ((1.0 + l / (values.x * values.x)) / (1.0 + l)), 1.0));
  }
  else if (curve == 7) result = srgbEncode(acesFit(v));
  else if (curve == 8) result = srgbEncode(agx(v));
  else if (curve == 9) result = srgbEncode(clamp(pbrNeutral(v), 0.0, 1.0));
  else result = srgbEncode(clamp(hableCurve(min(2.0 * v, 1e6)) / hableCurve(vec3(values.x)), 0.0, 1.0));
  return clamp(result, 0.0, 1.0);
}
`;
/** A tone from text as the command line takes it: `reinhard:white=4,exposure=1`. */
function parseTone(text, choices) {
	const [name = "none", settings = ""] = text.split(":", 2);
	const choice = choices.find((c) => c.name === name);
	const tone = {
		name: choice ? name : "none",
		values: choice?.parameters.map((p) => p.default) ?? [],
		exposure: 0
	};
	for (const setting of settings.split(",")) {
		const [key, value] = setting.split("=", 2);
		const at = choice?.parameters.findIndex((p) => p.name === key) ?? -1;
		if (key === "exposure") tone.exposure = Number(value) || 0;
		else if (at >= 0 && Number.isFinite(Number(value))) tone.values[at] = Number(value);
	}
	return tone;
}
/** The text of a tone without its exposure. */
function toneText(tone, choices) {
	const set = (choices.find((c) => c.name === tone.name)?.parameters ?? []).flatMap((p, i) => tone.values[i] === p.default ? [] : [`${p.name}=${tone.values[i]}`]);
	return set.length > 0 ? `${tone.name}:${set.join(",")}` : tone.name;
}
// src/compare.ts
/** Panel "Compare": the shown picture, A, beside B, in turn with it, minus it, or as a map of the differences one sees. */
/** Milliseconds that A and B are shown in turn. */
var TURN = 500;
var Compare = class {
	view;
	tell;
	element;
	divider;
	/** Which of the two is shown, over the picture. */
	tag = h("div", {
		class: "tag",
		hidden: true
	});
	about = null;
	/** Whether this page is changing B. */
	acts = false;
	/** Called when there is another B, or none. */
	changed = () => {};
	facts = h("p", { class: "facts" }, "Nothing is kept as B.");
	figures = h("p", {
		class: "facts",
		hidden: true
	});
	clearButton = h("button", {
		disabled: true,
		onclick: () => void this.act(clearReference)
	}, "Clear B");
	mode = h("select", {
		"aria-label": "Compare with B",
		onchange: () => this.choose(this.mode.value)
	}, ...[
		["off", "off"],
		["split", "split"],
		["flip", "A and B in turn"],
		["difference", "difference A − B"],
		["map", "FLIP map"]
	].map(([value, text]) => h("option", { value }, text)));
	gain;
	automatic = h("input", {
		type: "checkbox",
		onchange: () => this.update()
	});
	automaticRow = row("By itself", this.automatic, "A and B take turns of half a second; else by key B");
	file = h("input", {
		type: "file",
		hidden: true,
		tabindex: -1,
		"aria-label": "Picture to load as B"
	});
	map;
	state = null;
	timer = 0;
	isPreview = true;
	constructor(view, tell) {
		this.view = view;
		this.tell = tell;
		this.divider = new Divider((part) => {
			view.split = part;
			view.redraw();
		});
		this.map = new FlipMap(view, () => toneText(view.tone, this.state?.choices.tones ?? []), (figures) => this.showFigures(figures));
		const field = numberField({
			label: "Gain of the difference",
			value: 1,
			range: [.001, 1e6],
			slider: [.1, 1e3],
			change: (v) => {
				view.differenceGain = v;
				view.redraw();
			}
		});
		this.gain = row("Gain", field.element, "Grey where both are the same; with the exposure, 1 is a difference of 1 to white or black");
		this.file.addEventListener("change", () => {
			const file = this.file.files?.[0];
			this.file.value = "";
			if (file) this.act(() => keepReference(file));
		});
		const load = h("button", {
			title: "EXR, PNG, HDR, PFM, JPEG, …",
			onclick: () => this.file.click()
		}, "Load B");
		const keep = h("button", {
			title: "Keep the picture as it is now",
			onclick: () => void this.act(() => keepReference(null))
		}, "Keep as B");
		this.element = section("Compare", false, this.facts, h("div", { class: "buttons" }, keep, load, this.clearButton, this.file), row("Show", this.mode), this.gain, this.automaticRow, this.figures);
		this.update();
		this.fetch();
	}
	takeState(state) {
		this.state = state;
		this.place();
	}
	takeFrame({ kind }) {
		this.isPreview = kind === "preview";
		this.refresh();
	}
	/** How pictures are displayed, or the picture, has changed: so has the map. */
	refresh() {
		if (this.view.comparison === "map" && this.about && !this.isPreview) this.map.update();
	}
	/** Shows the other one of A and B. */
	alternate() {
		if (!this.about) return this.tell({
			severity: "note",
			text: "nothing is kept as B"
		});
		const isTurn = this.view.comparison === "flip";
		this.view.showsOther = isTurn ? !this.view.showsOther : true;
		this.choose("flip");
	}
	choose(mode) {
		this.mode.value = mode;
		this.view.comparison = mode;
		this.update();
		this.refresh();
	}
	/** B is another one; by another page, unless this one is about to take it. */
	changedElsewhere() {
		if (!this.acts) this.fetch();
	}
	/** Carries out what changes B, and takes the new one. */
	async act(change) {
		this.acts = true;
		try {
			await change();
			await this.fetch();
			if (this.about && this.view.comparison === "off") this.choose("split");
		} catch (error) {
			this.tell({
				severity: "error",
				text: error instanceof Error ? error.message : String(error)
			});
		} finally {
			this.acts = false;
		}
	}
	async fetch() {
		const found = await fetchReference().catch(() => null);
		this.about = found?.head ?? null;
		this.map.clear();
		if (found) {
			for (const tile of found.tiles) this.view.others.tile("reference", tile);
			this.view.others.swap([
				0,
				0,
				1,
				1
			], "reference");
		} else this.view.others.keep([]);
		this.place();
		this.update();
		this.refresh();
		this.changed();
	}
	/** B lies where it was rendered; a file on the whole film, or on the region that is as large as it. */
	place() {
		const [picture, about] = [this.view.others.shown("reference"), this.about];
		if (!picture || !about) return;
		const { film, region } = this.view;
		const isRegion = region && about.width === region[2] - region[0] && about.height === region[3] - region[1];
		const isFilm = about.width === film.width && about.height === film.height;
		picture.crop = about.crop ?? (isRegion && !isFilm ? region : [
			0,
			0,
			film.width,
			film.height
		]);
		const size = isFilm || isRegion || about.crop ? "" : `; the picture has ${film.width} × ${film.height}`;
		setText(this.facts, `B: ${about.name}, ${about.width} × ${about.height}${size}`);
	}
	update() {
		const { view, about } = this;
		const mode = about ? view.comparison : "off";
		if (!about) setText(this.facts, "Nothing is kept as B.");
		this.clearButton.disabled = this.mode.disabled = about === null;
		this.divider.element.hidden = mode !== "split";
		this.gain.hidden = mode !== "difference";
		this.automaticRow.hidden = mode !== "flip";
		if (mode !== "map") this.figures.hidden = true;
		clearInterval(this.timer);
		if (mode === "flip" && this.automatic.checked) this.timer = window.setInterval(() => {
			view.showsOther = !view.showsOther;
			this.label(mode);
			view.redraw();
		}, TURN);
		this.label(mode);
		view.redraw();
	}
	label(mode) {
		this.tag.hidden = mode === "off" || mode === "split";
		setText(this.tag, mode === "flip" ? this.view.showsOther ? "B" : "A" : mode === "map" ? "FLIP" : "A − B");
	}
	showFigures(figures) {
		this.figures.hidden = this.view.comparison !== "map";
		const number = (v) => v === null ? "∞" : show(v);
		setText(this.figures, typeof figures === "string" ? figures : `FLIP: mean ${number(figures.mean)}, 95 % below ${number(figures.quantile95)}; relMSE ${number(figures.relmse)}; PSNR ${number(figures.psnr)} dB`);
	}
};
// src/half.ts
/** IEEE half floats, and what a picture of them is like. */
/** The value of every half. */
var VALUES = (() => {
	const table = /* @__PURE__ */ new Float32Array(65536);
	for (let bits = 0; bits < 65536; bits++) {
		const sign = bits & 32768 ? -1 : 1;
		const exponent = bits >> 10 & 31;
		const fraction = bits & 1023;
		if (exponent === 31) table[bits] = fraction ? NaN : sign * Infinity;
		else table[bits] = sign * (exponent === 0 ? fraction * 2 ** -24 : (1024 + fraction) * 2 ** (exponent - 25));
	}
	return table;
})();
/** Luminances counted by the first 20 bits of their float: 11 bits of precision, as halves have. */
var SHIFT = 12;
var BINS = 522240;
var counts = new Uint32Array(BINS);
var float = /* @__PURE__ */ new Float32Array(1);
var bits = new Uint32Array(float.buffer);
/** Statistics; its counts hold until the next call. */
function statistics(halves, components) {
	counts.fill(0);
	let [largest, nonfinite, dark] = [
		0,
		0,
		0
	];
	const pixels = halves.length / components;
	const [g, b] = components === 3 ? [1, 2] : [0, 0];
	for (let i = 0; i < halves.length; i += components) {
		const [hr, hg, hb] = [
			halves[i],
			halves[i + g],
			halves[i + b]
		];
		if (hr < 31744 && hr > largest) largest = hr;
		if (hg < 31744 && hg > largest) largest = hg;
		if (hb < 31744 && hb > largest) largest = hb;
		if ((hr & 31744) === 31744 || (hg & 31744) === 31744 || (hb & 31744) === 31744) {
			nonfinite++;
			continue;
		}
		const luminance = .2126 * VALUES[hr] + .7152 * VALUES[hg] + .0722 * VALUES[hb];
		if (luminance > 0) {
			float[0] = luminance;
			counts[bits[0] >>> SHIFT]++;
		} else dark++;
	}
	return {
		maximum: VALUES[largest],
		nonfinite,
		dark,
		pixels,
		counts
	};
}
/** The nearest half of a number; what is beyond their range is the largest. */
function halfOf(v) {
	float[0] = v;
	const word = bits[0];
	const sign = word >>> 16 & 32768;
	if (Number.isNaN(v)) return 32256;
	const a = Math.abs(v);
	if (a > 65504) return sign | 31743;
	return sign | (a < 2 ** -14 ? Math.round(a * 2 ** 24) : (word & 2147483647) - 939524096 + 4096 >>> 13);
}
/** The middle of a bin. */
function middle(bin) {
	bits[0] = bin << SHIFT | 2048;
	return float[0];
}
/** Luminances of the pixels above zero, with their numbers of pixels. */
function* bins({ counts }) {
	for (let bin = 0; bin < BINS; bin++) if (counts[bin] > 0) yield [middle(bin), counts[bin]];
}
/** The luminance that this part of the pixels above zero doesn't exceed, or `null` where there are none. */
function percentile({ counts, pixels, nonfinite, dark }, part) {
	const bright = pixels - nonfinite - dark;
	if (bright === 0) return null;
	let left = Math.round(part * (bright - 1));
	for (let bin = 0; bin < BINS; bin++) {
		left -= counts[bin];
		if (left < 0) return middle(bin);
	}
	return null;
}
/** Pixels by log2 of their luminance: `steps` bins for each power of two from `low` to `high`; the ends hold what is beyond. */
function octaves({ counts }, low, high, steps) {
	const bins = new Array((high - low) * steps).fill(0);
	for (let bin = 0; bin < BINS; bin++) {
		const count = counts[bin];
		if (count === 0) continue;
		const at = Math.floor((Math.log2(middle(bin)) - low) * steps);
		bins[Math.min(Math.max(at, 0), bins.length - 1)] += count;
	}
	return bins;
}
// src/convergence.ts
/** Errors against time or samples: what a render's frames tell, kept to compare renders. */
/** A render of fewer frames is none that is kept. */
var FEWEST_POINTS = 3;
/** Frames come this much later than the one before, in time or samples, to count. */
var APART = 1.04;
var Convergence = class {
	/** The last one grows. */
	curves = [];
	/** Takes a frame of a render, whose error to B is computed where it counts. */
	take(frame, label, toReference) {
		const { generation, seconds, samples, error, done } = frame;
		if (frame.kind === "preview" || samples <= 0 || seconds <= 0) return false;
		let curve = this.curves.at(-1);
		const last = curve?.points.at(-1);
		const goesOn = curve && last && curve.label === label && (curve.generation === generation || samples > last.samples);
		if (!curve || !goesOn || last && (samples < last.samples || seconds < last.seconds)) curve = this.begin(label, generation);
		else if (last && (samples <= last.samples || !done && seconds < APART * last.seconds && samples < APART * last.samples)) return false;
		curve.generation = generation;
		curve.points.push({
			seconds,
			samples,
			error,
			toReference: toReference()
		});
		return true;
	}
	/** B is another one: errors to the old one mean nothing. */
	forgetReference() {
		for (const curve of this.curves) for (const point of curve.points) point.toReference = null;
	}
	remove(curve) {
		this.curves = this.curves.filter((c) => c !== curve);
	}
	begin(label, generation) {
		const curve = {
			label,
			generation,
			points: []
		};
		const kept = this.curves.filter((c) => c.label !== label && c.points.length >= FEWEST_POINTS);
		this.curves = [...kept.slice(-3), curve];
		return curve;
	}
};
/** The relMSE, mean of (x − r)² / (r² + 0.01), of two pictures of a size; `null` where nothing is finite in both. */
function relMse(picture, reference) {
	const [a, b] = [picture.halves, reference.halves];
	if (a.length !== b.length || picture.width !== reference.width || picture.crop.join() !== reference.crop.join()) return null;
	let [sum, count] = [0, 0];
	for (let i = 0; i < a.length; i++) {
		const [x, r] = [VALUES[a[i]], VALUES[b[i]]];
		const e = (x - r) * (x - r) / (r * r + .01);
		if (e < Infinity) {
			sum += e;
			count++;
		}
	}
	return count > 0 ? sum / count : null;
}
// src/plot.ts
/** A small plot with two logarithmic axes, as SVG. */
var NAMESPACE = "http://www.w3.org/2000/svg";
var WIDTH$1 = 294;
var HEIGHT$1 = 190;
var LEFT = 40;
var TOP = 6;
function svg$1(tag, attributes, ...children) {
	const element = document.createElementNS(NAMESPACE, tag);
	for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
	element.append(...children);
	return element;
}
/** Powers of ten within, with 2 and 5 where there are few. */
function ticks(low, high) {
	const factors = Math.log10(high / low) < 1.7 ? [
		1,
		2,
		5
	] : [1];
	const step = Math.max(1, Math.ceil(Math.log10(high / low) / 6));
	const found = [];
	for (let e = Math.floor(Math.log10(low)); e <= Math.log10(high); e += step) for (const f of factors) {
		const v = Number(`${f}e${e}`);
		if (v >= low * .999 && v <= high * 1.001) found.push(v);
	}
	return found;
}
/** 10 to the power where it's short. */
function text$2(v) {
	return v >= .01 && v < 1e4 ? String(v) : v.toExponential(0).replace("e+", "e").replace("-", "−");
}
/** The ends of an axis around values: some room, and at least half a decade. */
function ends(values) {
	const [low, high] = [Math.min(...values), Math.max(...values)];
	const middle = Math.sqrt(low * high);
	const factor = Math.max(Math.sqrt(high / low) * 1.15, 10 ** .25);
	return [middle / factor, middle * factor];
}
/** The plot of lines; a line of slope −1/2 lies beside them, from the first one's beginning. */
function plot(title, description, xName, lines) {
	const all = lines.flatMap((line) => line.points);
	const [x0, x1] = ends(all.map((p) => p[0]));
	const [y0, y1] = ends(all.map((p) => p[1]));
	const x = (v) => LEFT + 248 * Math.log(v / x0) / Math.log(x1 / x0);
	const y = (v) => 170 - 164 * Math.log(v / y0) / Math.log(y1 / y0);
	const root = svg$1("svg", {
		class: "plot",
		viewBox: `0 0 ${WIDTH$1} ${HEIGHT$1}`,
		role: "img",
		"aria-labelledby": "plot-title",
		"aria-describedby": "plot-description"
	}, svg$1("title", { id: "plot-title" }, title), svg$1("desc", { id: "plot-description" }, description), svg$1("clipPath", { id: "plot-inside" }, svg$1("rect", {
		x: LEFT,
		y: TOP,
		width: 248,
		height: 164
	})));
	for (const v of ticks(x0, x1)) root.append(svg$1("line", {
		class: "grid",
		x1: x(v),
		x2: x(v),
		y1: TOP,
		y2: 170
	}), svg$1("text", {
		x: x(v),
		y: 183,
		"text-anchor": "middle"
	}, text$2(v)));
	for (const v of ticks(y0, y1)) root.append(svg$1("line", {
		class: "grid",
		x1: LEFT,
		x2: 288,
		y1: y(v),
		y2: y(v)
	}), svg$1("text", {
		x: 36,
		y: y(v) + 3,
		"text-anchor": "end"
	}, text$2(v)));
	root.append(svg$1("text", {
		class: "axis",
		x: 286,
		y: 166,
		"text-anchor": "end"
	}, xName));
	const inside = svg$1("g", { "clip-path": "url(#plot-inside)" });
	const first = lines[0].points[0];
	const slope = (v) => 1.5 * first[1] * Math.sqrt(first[0] / v);
	inside.append(svg$1("path", {
		class: "slope",
		d: `M${x(x0)} ${y(slope(x0))}L${x(x1)} ${y(slope(x1))}`
	}));
	for (const line of lines) {
		const places = line.points.map(([a, b]) => `${x(a).toFixed(1)} ${y(b).toFixed(1)}`);
		inside.append(svg$1("path", {
			class: `curve ${line.style}`,
			d: `M${places.join("L")}`
		}, svg$1("title", {}, line.label)));
		const [a, b] = line.points.at(-1);
		inside.append(svg$1("circle", {
			class: `end ${line.style}`,
			cx: x(a).toFixed(1),
			cy: y(b).toFixed(1),
			r: 2.5
		}));
	}
	root.append(inside);
	return root;
}
// src/errors.ts
/** Panel "Error": how it falls as a render goes on, beside the renders before. */
/** Milliseconds between drawings. */
var PAUSE$1 = 250;
var Errors = class {
	view;
	element;
	convergence = new Convergence();
	axis = h("select", {
		"aria-label": "Error against",
		onchange: () => this.draw()
	}, ...["seconds", "samples"].map((value) => h("option", { value }, value)));
	place = h("div", { class: "plots" });
	list = h("ul", { class: "curves" });
	table = h("details", {
		class: "numbers",
		ontoggle: () => this.fillTable()
	}, h("summary", {}, "Table"));
	state = null;
	timer = 0;
	/** Which colour each curve has. */
	colors = /* @__PURE__ */ new Map();
	constructor(view) {
		this.view = view;
		this.element = section("Error", false, row("Against", this.axis), this.place, this.list, this.table);
		this.element.addEventListener("toggle", () => this.draw());
		this.draw();
	}
	takeState(state) {
		this.state = state;
	}
	/** A frame that's shown now. */
	takeFrame(frame) {
		if (this.convergence.take(frame, this.state?.settings.integrator || "the scene’s", () => this.toReference()) && !this.timer) this.timer = window.setTimeout(() => this.draw(), PAUSE$1);
	}
	/** There is another B, or none. */
	changeReference() {
		this.convergence.forgetReference();
		this.draw();
	}
	toReference() {
		const [picture, reference] = [this.view.layers.shown("picture"), this.view.others.shown("reference")];
		const found = picture && reference && relMse(picture, reference);
		return found === null ? null : Math.sqrt(found);
	}
	draw() {
		clearTimeout(this.timer);
		this.timer = 0;
		if (!this.element.open) return;
		const { curves } = this.convergence;
		for (const curve of [...this.colors.keys()]) if (!curves.includes(curve)) this.colors.delete(curve);
		for (const curve of curves) {
			const used = [...this.colors.values()];
			if (!this.colors.has(curve)) this.colors.set(curve, [...Array(4).keys()].find((c) => !used.includes(c)) ?? 0);
		}
		const axis = this.axis.value;
		const lines = curves.flatMap((curve) => this.lines(curve, axis));
		this.table.hidden = lines.length === 0;
		if (lines.length === 0) this.place.replaceChildren(h("p", { class: "facts" }, "A render of some frames is drawn here."));
		else {
			const about = `Both axes are logarithmic; the dotted line has the slope −1/2. ${lines.map((l) => `${l.label}: ${show(l.points.at(-1)[1])} at ${show(l.points.at(-1)[0])} ${axis}`).join("; ")}.`;
			const key = lines.some((l) => l.style.includes("measured")) ? "Lines: the estimate. Dashes: the root of the relMSE to B. " : "";
			this.place.replaceChildren(plot(`Relative error against ${axis}`, about, axis === "samples" ? "samples per pixel" : axis, lines), h("p", { class: "facts" }, `${key}Dots: slope −1/2.`));
		}
		this.list.replaceChildren(...curves.filter((c) => this.lines(c, axis).length > 0).map((curve) => this.item(curve)));
		this.fillTable();
	}
	/** The estimate, and the error to B where there is one. */
	lines(curve, axis) {
		const color = `curve-${this.colors.get(curve)}`;
		const of = (key, style, label) => {
			const points = curve.points.flatMap((p) => {
				const v = p[key];
				return v !== null && v > 0 ? [[p[axis], v]] : [];
			});
			return points.length > 0 ? [{
				style: `${color} ${style}`,
				label,
				points
			}] : [];
		};
		return [...of("error", "estimated", `${curve.label}, estimated`), ...of("toReference", "measured", `${curve.label}, root of the relMSE to B`)];
	}
	item(curve) {
		const remove = () => {
			this.convergence.remove(curve);
			this.draw();
		};
		const name = `Remove the curve of ${curve.label}`;
		return h("li", {}, h("span", { class: `swatch curve-${this.colors.get(curve)}` }), h("span", { class: "id" }, curve.label), h("button", {
			class: "small",
			title: name,
			"aria-label": name,
			onclick: remove
		}, "×"));
	}
	fillTable() {
		if (!this.table.open) return;
		const value = (v) => v === null ? "–" : show(v);
		const head = [
			"render",
			"seconds",
			"spp",
			"error",
			"to B"
		].map((text) => h("th", { scope: "col" }, text));
		const rows = this.convergence.curves.flatMap((curve) => curve.points.map((p) => h("tr", {}, h("th", { scope: "row" }, curve.label), ...[
			p.seconds,
			p.samples,
			p.error,
			p.toReference
		].map((v) => h("td", {}, value(v))))));
		const table = h("table", { class: "errors" }, h("thead", {}, h("tr", {}, ...head)), h("tbody", {}, ...rows));
		this.table.replaceChildren(this.table.firstElementChild, table);
	}
};
// src/histogram.ts
/** Panel "Histogram": luminance by powers of two, the share that is clipped, and what isn't finite. */
var LOW = -14;
var HIGH = 10;
var STEPS = 4;
var WIDTH = 280;
var HEIGHT = 72;
var Histogram = class {
	element;
	canvas = h("canvas", {
		width: 2 * WIDTH,
		height: 144,
		role: "img",
		"aria-label": "Histogram of luminance"
	});
	facts = h("p", { class: "facts" });
	last = 0;
	timer = 0;
	constructor() {
		this.element = section("Histogram", true, this.canvas, this.facts);
	}
	/** Shows statistics, at most a few times a second; `exposure` in EV. */
	update(of, exposure) {
		if (!this.element.open) return;
		clearTimeout(this.timer);
		const wait = this.last + 200 - performance.now();
		if (wait > 0) {
			this.timer = window.setTimeout(() => this.update(of, exposure), wait);
			return;
		}
		const found = of();
		if (found) this.draw(found, exposure);
		this.last = performance.now();
	}
	draw(found, exposure) {
		const bins = octaves(found, LOW, HIGH, STEPS);
		const most = Math.max(...bins, 1);
		const context = this.canvas.getContext("2d");
		const style = getComputedStyle(this.canvas);
		const color = (name) => style.getPropertyValue(name);
		context.setTransform(2, 0, 0, 2, 0, 0);
		context.clearRect(0, 0, WIDTH, HEIGHT);
		const at = (ev) => (ev - LOW) / 24 * WIDTH;
		const bottom = 58;
		context.fillStyle = color("--muted");
		context.font = "10px system-ui, sans-serif";
		context.textAlign = "center";
		for (let ev = -12; ev < HIGH; ev += 4) {
			context.fillRect(at(ev), bottom, 1, 3);
			context.fillText(String(ev).replace("-", "−"), at(ev), 70);
		}
		const white = -exposure;
		let clipped = 0;
		bins.forEach((count, i) => {
			const ev = LOW + i / STEPS;
			if (ev >= white) clipped += count;
			if (count === 0) return;
			context.fillStyle = ev >= white ? color("--warn") : color("--accent");
			const height = Math.max(1, 56 * Math.sqrt(count / most));
			context.fillRect(at(ev), bottom - height, WIDTH / bins.length - .5, height);
		});
		context.fillStyle = color("--text");
		if (white > LOW && white < HIGH) context.fillRect(at(white), 0, 1, bottom);
		const share = (count) => `${(100 * count / found.pixels).toFixed(count === 0 ? 0 : 2)} %`;
		const odd = found.nonfinite > 0 ? `; not finite: ${found.nonfinite}` : "";
		setText(this.facts, `EV of luminance; above 1: ${share(clipped)}; zero or below: ${share(found.dark)}; largest ${show(found.maximum)}${odd}`);
	}
};
// src/exposure.ts
/** Exposures by the picture, as `--exposure auto` and the defaults of models choose them. */
/** Luminance of mid-grey, and of what is bright but not white. */
var GREY = .18;
var BRIGHT = .8;
/** Value below which a display shows black, if nearly all of a picture lies there. */
var DARK = .02;
/** Stops, to a tenth, by which the geometric mean of what is lit becomes mid-grey, but no more than a tenth of it white; `null` where nothing is lit. */
function averageStops(of) {
	const high = percentile(of, .9);
	const mean = meanLog2(of);
	if (high === null || mean === null) return null;
	return Math.round(10 * Math.min(Math.log2(GREY) - mean, -Math.log2(high))) / 10;
}
/** Stops that show more of a picture that is white or black as it is; `null` where it is neither. */
function neededStops(of) {
	const [low, middle, high] = [
		percentile(of, .4),
		percentile(of, .5),
		percentile(of, .98)
	];
	if (low === null || middle === null || high === null) return null;
	if (low > 1) return Math.round(Math.log2(GREY / middle));
	return high < DARK ? Math.round(Math.log2(BRIGHT / high)) : null;
}
/** Mean binary logarithm of the luminances above zero. */
function meanLog2(of) {
	let [sum, count] = [0, 0];
	for (const [luminance, pixels] of bins(of)) {
		sum += pixels * Math.log2(luminance);
		count += pixels;
	}
	return count > 0 ? sum / count : null;
}
// src/look.ts
/** Panel "View": exposure, tone curve with its parameters, layer, false colour. Nothing here asks for a render. */
var Look = class {
	view;
	askLayers;
	changed;
	element;
	exposure;
	tone = h("select", {
		"aria-label": "Tone curve",
		onchange: () => this.choose(this.tone.value)
	});
	parameters = h("div");
	layer = h("select", {
		"aria-label": "Layer",
		onchange: () => this.chooseLayer(this.layer.value)
	});
	falseColor = h("input", {
		type: "checkbox",
		onchange: () => this.setFalse(this.falseColor.checked)
	});
	mark = h("input", {
		type: "checkbox",
		checked: true,
		onchange: () => this.set(() => this.view.isMarked = this.mark.checked)
	});
	state = null;
	scene = "";
	/** Exposure that the scene's first picture is to choose. */
	awaited = "given";
	constructor(view, askLayers, changed) {
		this.view = view;
		this.askLayers = askLayers;
		this.changed = changed;
		this.exposure = numberField({
			label: "Exposure in EV",
			value: 0,
			range: [-64, 64],
			slider: [-16, 16],
			step: .1,
			unit: "EV",
			change: (v) => this.expose(v)
		});
		this.element = section("View", true, row("Exposure", this.exposure.element, "Powers of two; keys [ and ]"), h("div", { class: "buttons" }, h("button", {
			title: "What is lit becomes grey on average",
			onclick: () => this.exposeBy("auto")
		}, "Expose by the picture")), row("Tone", this.tone), this.parameters, row("Layer", this.layer), row("False colour", this.falseColor, "Luminance as a colour of viridis, on a logarithmic scale"), row("Mark NaN", this.mark, "Pixels that are NaN or infinite become magenta"));
	}
	update(state) {
		const isFirst = this.state === null;
		this.state = state;
		const known = state.choices.tones.filter((t) => CURVES.includes(t.name));
		setOptions(this.tone, known.map((t) => ({
			value: t.name,
			title: t.doc
		})));
		const layers = state.choices.layers.filter((l) => l.name !== "picture");
		setOptions(this.layer, [{ value: "picture" }, ...layers.map((l) => ({
			value: l.name,
			title: l.doc
		}))]);
		setValue(this.layer, this.view.layer);
		const { name, path } = state.scene;
		const scene = `${path ?? name}`;
		if (isFirst || scene !== this.scene) this.awaited = state.exposure;
		this.scene = scene;
		if (isFirst) {
			this.view.tone = parseTone(state.tone, state.choices.tones);
			this.exposure.set(this.view.tone.exposure);
			this.tone.value = this.view.tone.name;
			this.showParameters();
		}
		this.view.layers.keep([
			"picture",
			...state.layers,
			this.view.layer
		]);
	}
	/** Takes a picture of the scene: the first one may choose the exposure. */
	takeFrame() {
		const { awaited } = this;
		if (awaited === "given" || this.view.layer !== "picture") return;
		this.awaited = "given";
		this.exposeBy(awaited);
	}
	/** Exposes by the picture, or if that is `needed`. */
	exposeBy(way) {
		const found = this.view.statistics();
		const stops = found && (way === "auto" ? averageStops(found) : neededStops(found));
		if (stops !== null) this.expose(stops);
	}
	expose(ev) {
		this.awaited = "given";
		const exposure = Math.min(Math.max(ev, -64), 64);
		this.exposure.set(exposure);
		this.set(() => this.view.tone.exposure = exposure);
	}
	setFalse(on) {
		this.falseColor.checked = on;
		this.set(() => this.view.isFalse = on);
	}
	/** The next or previous layer. */
	stepLayer(by) {
		const count = this.layer.options.length;
		if (count === 0) return;
		this.layer.selectedIndex = (this.layer.selectedIndex + by + count) % count;
		this.chooseLayer(this.layer.value);
	}
	choose(name) {
		const tone = parseTone(name, this.state?.choices.tones ?? []);
		this.set(() => this.view.tone = {
			...tone,
			exposure: this.view.tone.exposure
		});
		this.showParameters();
	}
	chooseLayer(name) {
		this.set(() => this.view.layer = name);
		if (this.state) this.askLayers(name === "picture" ? [] : [name]);
	}
	showParameters() {
		const choice = this.state?.choices.tones.find((t) => t.name === this.view.tone.name);
		this.parameters.replaceChildren(...(choice?.parameters ?? []).map((p, i) => {
			const field = numberField({
				label: `${choice.name}: ${p.name}`,
				value: this.view.tone.values[i] ?? p.default,
				range: p.range,
				slider: [Math.max(p.range[0], p.default / 100), Math.min(p.range[1], p.default * 100)],
				change: (v) => this.set(() => this.view.tone.values[i] = v)
			});
			return row(p.name, field.element, `${p.doc} (${show(p.range[0])} to ${show(p.range[1])}; ${show(p.default)} when not given)`);
		}));
	}
	set(change) {
		change();
		this.view.redraw();
		this.changed();
	}
};
// src/messages.ts
/** Panel "Messages", and the newest one over the picture for some seconds. */
var SHOWN = 8e3;
var KEPT$1 = 100;
var Messages = class {
	element;
	toast = h("div", {
		class: "toast",
		role: "status",
		hidden: true
	});
	list = h("ul", { class: "messages" });
	none = h("p", { class: "facts" }, "No messages.");
	clear = h("button", {
		hidden: true,
		onclick: () => this.empty()
	}, "Clear");
	own = [];
	ofScene = [];
	timer = 0;
	constructor() {
		this.element = section("Messages", false, this.none, this.list, this.clear);
	}
	/** The scene's own messages. */
	scene(messages) {
		if (JSON.stringify(messages) === JSON.stringify(this.ofScene)) return;
		this.ofScene = messages;
		this.fill();
	}
	add(message) {
		this.own = [message, ...this.own].slice(0, KEPT$1);
		this.fill();
		this.toast.className = `toast ${message.severity}`;
		this.toast.setAttribute("role", message.severity === "error" ? "alert" : "status");
		this.toast.hidden = false;
		setText(this.toast, message.text);
		clearTimeout(this.timer);
		this.timer = window.setTimeout(() => this.toast.hidden = true, SHOWN);
	}
	empty() {
		this.own = [];
		this.fill();
	}
	fill() {
		const all = [...this.own, ...this.ofScene];
		this.none.hidden = all.length > 0;
		this.clear.hidden = this.own.length === 0;
		const items = all.map(({ severity, text }) => h("li", { class: severity }, h("span", { class: "severity" }, severity), text));
		this.list.replaceChildren(...items);
		setText(this.element.querySelector("h2"), all.length > 0 ? `Messages (${all.length})` : "Messages");
	}
};
// src/color.ts
/** Linear Rec.709 colours in the browser's picker, which is of sRGB in 8 bits. */
var encode = (v) => v <= .0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - .055;
var decode = (v) => v <= .04045 ? v / 12.92 : ((v + .055) / 1.055) ** 2.4;
/** `#rrggbb` of a linear colour, cut to [0, 1]. */
function hexOf(rgb) {
	return "#" + rgb.map((v) => Math.round(255 * encode(Math.min(Math.max(v, 0), 1))).toString(16).padStart(2, "0")).join("");
}
/** The linear colour of `#rrggbb`, to four digits. */
function linearOf(hex) {
	return [
		1,
		3,
		5
	].map((at) => Number(decode(parseInt(hex.slice(at, at + 2), 16) / 255).toPrecision(4)));
}
// src/layers.ts
/** Puts a tile's halves among those of its frame. */
function put(halves, tile) {
	const row = tile.width * tile.components;
	for (let y = 0; y < tile.height; y++) halves.set(tile.halves.subarray(y * row, (y + 1) * row), ((tile.y + y) * tile.frameWidth + tile.x) * tile.components);
}
var Layers = class {
	gl;
	layers = /* @__PURE__ */ new Map();
	constructor(gl) {
		this.gl = gl;
		gl.pixelStorei(gl.UNPACK_ALIGNMENT, 2);
	}
	/** The frame of a layer to be shown. */
	shown(layer) {
		return this.layers.get(layer)?.front ?? null;
	}
	/** Takes a tile of the frame that comes. */
	tile(name, tile) {
		const { gl } = this;
		const layer = this.layers.get(name) ?? {
			front: null,
			back: null,
			isFresh: false
		};
		this.layers.set(name, layer);
		const [width, height, components] = [
			tile.frameWidth,
			tile.frameHeight,
			tile.components
		];
		const back = layer.back;
		if (!back || back.width !== width || back.height !== height || back.components !== components) {
			if (back) gl.deleteTexture(back.texture);
			layer.back = this.create(width, height, components);
		}
		const picture = layer.back;
		layer.isFresh = true;
		gl.bindTexture(gl.TEXTURE_2D, picture.texture);
		const format = components === 1 ? gl.RED : gl.RGB;
		gl.texSubImage2D(gl.TEXTURE_2D, 0, tile.x, tile.y, tile.width, tile.height, format, gl.HALF_FLOAT, tile.halves);
		put(picture.halves, tile);
	}
	/** A frame is whole: shows the layers that came with it, or this one of them, as a part of the film. */
	swap(crop, only) {
		for (const [name, layer] of this.layers) {
			if (!layer.back || !layer.isFresh || only !== void 0 && name !== only) continue;
			layer.back.crop = crop;
			layer.isFresh = false;
			[layer.front, layer.back] = [layer.back, layer.front];
		}
	}
	/** Forgets layers but these. */
	keep(names) {
		for (const [name, layer] of this.layers) {
			if (names.includes(name)) continue;
			for (const picture of [layer.front, layer.back]) if (picture) this.gl.deleteTexture(picture.texture);
			this.layers.delete(name);
		}
	}
	create(width, height, components) {
		const { gl } = this;
		const texture = gl.createTexture();
		gl.bindTexture(gl.TEXTURE_2D, texture);
		gl.texStorage2D(gl.TEXTURE_2D, 1, components === 1 ? gl.R16F : gl.RGB16F, width, height);
		gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
		gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
		gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
		gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
		return {
			texture,
			width,
			height,
			components,
			halves: new Uint16Array(width * height * components),
			crop: [
				0,
				0,
				width,
				height
			]
		};
	}
};
var Groups = class {
	gl;
	/** Those of the shown frame, in the order of their planes; none where it came without. */
	names = [];
	/** All planes, as layers of one texture. */
	texture;
	/** Factors of red, green and blue for each group. */
	weights = (/* @__PURE__ */ new Float32Array(96)).fill(1);
	size = [
		1,
		1,
		1
	];
	front = [];
	back = [];
	constructor(gl) {
		this.gl = gl;
		this.texture = this.create();
	}
	/** Takes a tile of the frame that comes. */
	tile(group, tile) {
		if (group >= 32 || tile.components !== 3) return;
		const count = 3 * tile.frameWidth * tile.frameHeight;
		if (this.back[group]?.length !== count) this.back[group] = new Uint16Array(count);
		put(this.back[group], tile);
	}
	/** A frame is whole: shows the planes that came with it, if any did. */
	swap(names, width, height) {
		const isWhole = names.length <= 32 && names.every((_, g) => this.back[g]?.length === 3 * width * height);
		this.names = isWhole ? names : [];
		if (this.names.length === 0) return;
		[this.front, this.back] = [this.back, this.front];
		const { gl } = this;
		const size = [
			width,
			height,
			names.length
		];
		if (size.some((n, i) => n !== this.size[i])) {
			this.size = size;
			gl.deleteTexture(this.texture);
			this.texture = this.create();
		}
		gl.bindTexture(gl.TEXTURE_2D_ARRAY, this.texture);
		for (let g = 0; g < names.length; g++) gl.texSubImage3D(gl.TEXTURE_2D_ARRAY, 0, 0, 0, g, width, height, 1, gl.RGB, gl.HALF_FLOAT, this.front[g]);
	}
	/** Forgets all planes. */
	clear() {
		if (this.front.length + this.back.length === 0) return;
		[this.names, this.front, this.back, this.size] = [
			[],
			[],
			[],
			[
				1,
				1,
				1
			]
		];
		this.gl.deleteTexture(this.texture);
		this.texture = this.create();
	}
	/** The mixed colour of a pixel, by its number. */
	at(pixel) {
		const sum = [
			0,
			0,
			0
		];
		for (let g = 0; g < this.names.length; g++) for (let c = 0; c < 3; c++) {
			const weight = this.weights[3 * g + c];
			if (weight > 0) sum[c] += weight * VALUES[this.front[g][3 * pixel + c]];
		}
		return sum;
	}
	/** The mixed picture. */
	mixed() {
		const sums = new Float32Array(this.front[0]?.length ?? 0);
		for (let g = 0; g < this.names.length; g++) {
			const plane = this.front[g];
			for (let c = 0; c < 3; c++) {
				const weight = this.weights[3 * g + c];
				if (weight > 0) for (let i = c; i < sums.length; i += 3) sums[i] += weight * VALUES[plane[i]];
			}
		}
		return Uint16Array.from(sums, halfOf);
	}
	create() {
		const { gl } = this;
		const [width, height, depth] = this.size;
		const texture = gl.createTexture();
		gl.bindTexture(gl.TEXTURE_2D_ARRAY, texture);
		gl.texStorage3D(gl.TEXTURE_2D_ARRAY, 1, gl.RGB16F, width, height, depth);
		gl.texParameteri(gl.TEXTURE_2D_ARRAY, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
		gl.texParameteri(gl.TEXTURE_2D_ARRAY, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
		gl.texParameteri(gl.TEXTURE_2D_ARRAY, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
		gl.texParameteri(gl.TEXTURE_2D_ARRAY, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
		return texture;
	}
};
/** `mixedAt(at)`: the weighted sum of all groups. One that's put out adds nothing, whatever it holds. */
var MIX_GLSL = `
uniform highp sampler2DArray groups;
uniform int groupCount;                      // 0 where the picture is shown as it is
uniform vec3 weights[32];

vec3 mixedAt(vec2 at) {
  ivec2 size = textureSize(groups, 0).xy;
  ivec2 texel = min(ivec2(at * vec2(size)), size - 1);
  vec3 sum = vec3(0.0);
  for (int i = 0; i < groupCount; i++) {
    vec3 v = isNearest ? texelFetch(groups, ivec3(texel, i), 0).rgb : texture(groups, vec3(at, float(i))).rgb;
    sum += mix(vec3(0.0), weights[i] * v, greaterThan(weights[i], vec3(0.0)));
  }
  return sum;
}
`;
// src/mixer.ts
/** Panel "Light groups": how bright, and of which colour, each group of lights is shown. Only the switch asks for a render. */
/** Stops by which a group is brightened or dimmed at most. */
var STOPS = 6;
var WHITE$1 = "#ffffff";
var ABOUT = "Renders the light of each lamp, or of lamps of the same name, apart. What they add up to is then mixed without a render.";
var KEPT = "The mix is of this page: previews, B and saved files are without it; an EXR has a layer for each group.";
/** A group in the mixer. */
var Strip = class {
	element;
	stops = 0;
	mute;
	solo;
	color;
	field;
	constructor(name, changed) {
		this.field = numberField({
			label: `${name}: intensity in EV`,
			value: 0,
			range: [-6, STOPS],
			slider: [-6, STOPS],
			step: .1,
			unit: "EV",
			change: (v) => {
				this.stops = v;
				changed();
			}
		});
		const toggle = (letter, what, title) => {
			const press = () => {
				setPressed(button, !isPressed(button));
				changed();
			};
			const button = h("button", {
				class: "small",
				title,
				"aria-label": `${name}: ${what}`,
				"aria-pressed": "false",
				onclick: press
			}, letter);
			return button;
		};
		this.mute = toggle("M", "mute", "Mute: put this group out");
		this.solo = toggle("S", "solo", "Solo: put all groups out that are not solo");
		this.color = h("input", {
			type: "color",
			value: WHITE$1,
			title: "Colour that the light is multiplied by",
			"aria-label": `${name}: colour`,
			oninput: changed
		});
		const head = h("div", { class: "strip-head" }, h("span", {
			class: "id",
			title: name
		}, name), this.color, this.mute, this.solo);
		this.element = h("div", { class: "strip" }, head, this.field.element);
	}
	reset() {
		this.stops = 0;
		this.field.set(0);
		this.color.value = WHITE$1;
		for (const button of [this.mute, this.solo]) setPressed(button, false);
	}
};
var Mixer = class {
	view;
	changed;
	element;
	on;
	facts = h("p", { class: "facts" }, ABOUT);
	list = h("div", {
		role: "group",
		"aria-label": "Mixer"
	});
	buttons = h("div", { class: "buttons" }, h("button", { onclick: () => this.reset() }, "Reset mix"));
	/** Those that were there before keep their places. */
	strips = /* @__PURE__ */ new Map();
	names = [];
	/** Of which scene. */
	scene = "";
	constructor(view, send, changed) {
		this.view = view;
		this.changed = changed;
		this.on = h("input", {
			type: "checkbox",
			onchange: () => send({
				type: "settings",
				lightGroups: this.on.checked
			})
		});
		this.element = section("Light groups", false, row("Mix", this.on, ABOUT), this.facts, this.list, this.buttons);
	}
	update({ scene, settings }) {
		const isOn = settings.lightGroups;
		const of = `${scene.path} ${scene.name}`;
		if (of !== this.scene) {
			this.scene = of;
			this.names = [];
			this.strips.clear();
		}
		this.element.hidden = scene.lights === 0;
		this.on.checked = isOn;
		if (!isOn) {
			this.view.groups.clear();
			this.names = [];
			this.list.replaceChildren();
		}
		this.buttons.hidden = this.names.length === 0;
		setText(this.facts, isOn ? KEPT : ABOUT);
	}
	/** Shows the groups of a frame; of one that came without, those stay that were there. */
	takeFrame({ lightGroups }) {
		const isSame = lightGroups.length === this.names.length && lightGroups.every((name, g) => name === this.names[g]);
		if (lightGroups.length === 0 || isSame) return;
		this.names = lightGroups;
		const strips = lightGroups.map((name) => {
			const strip = this.strips.get(name) ?? new Strip(name, () => this.mix());
			this.strips.set(name, strip);
			return strip.element;
		});
		this.list.replaceChildren(...strips);
		this.buttons.hidden = false;
		this.mix();
	}
	reset() {
		for (const strip of this.strips.values()) strip.reset();
		this.mix();
	}
	mix() {
		const strips = this.names.map((name) => this.strips.get(name));
		const someSolo = strips.some((s) => isPressed(s.solo));
		const weights = /* @__PURE__ */ new Float32Array(96);
		strips.forEach((s, g) => {
			if (isPressed(s.mute) || someSolo && !isPressed(s.solo)) return;
			weights.set(linearOf(s.color.value).map((v) => v * 2 ** s.stops), 3 * g);
		});
		this.view.mix(weights);
		this.changed();
	}
};
// src/first.ts
var FIRST = /* @__PURE__ */ new Set([
	...[
		"base_color",
		"color",
		"reflectance",
		"diffuse_reflectance",
		"specular_reflectance",
		"albedo",
		"transmittance"
	],
	...[
		"roughness",
		"specular_roughness",
		"alpha",
		"alpha_u",
		"alpha_v",
		"exponent",
		"beta_m",
		"beta_n"
	],
	...[
		"metallic",
		"base_metalness",
		"eta",
		"k",
		"specular_ior",
		"index",
		"emission",
		"opacity",
		"geometry_opacity"
	],
	...[
		"file",
		"material",
		"front",
		"back",
		"amount"
	]
]);
/** Those that are shown at once, and those that are folded; of nodes of other families, and where none matters first, all are shown. */
function split({ family, parameters }) {
	const first = parameters.filter((p) => FIRST.has(p.name));
	if (family !== "material" || first.length === 0) return [parameters, []];
	return [first, parameters.filter((p) => !FIRST.has(p.name))];
}
// src/vector.ts
var add = (a, b) => [
	a[0] + b[0],
	a[1] + b[1],
	a[2] + b[2]
];
var sub = (a, b) => [
	a[0] - b[0],
	a[1] - b[1],
	a[2] - b[2]
];
var scale = (a, s) => [
	a[0] * s,
	a[1] * s,
	a[2] * s
];
var dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
var cross = (a, b) => [
	a[1] * b[2] - a[2] * b[1],
	a[2] * b[0] - a[0] * b[2],
	a[0] * b[1] - a[1] * b[0]
];
var length = (a) => Math.hypot(...a);
var normalize = (a) => scale(a, 1 / (length(a) || 1));
/** `a` without its part along the unit vector `axis`. */
var across = (a, axis) => sub(a, scale(axis, dot(a, axis)));
/** `a`, turned about the unit vector `axis` (right-handed, radians; Rodrigues' formula). */
function turn(a, axis, angle) {
	const [c, s] = [Math.cos(angle), Math.sin(angle)];
	return add(add(scale(a, c), scale(cross(axis, a), s)), scale(axis, dot(axis, a) * (1 - c)));
}
// src/place.ts
/** Transforms as location, rotation and scale. */
/** More than this part of shear is told from rounding. */
var SHEAR = 1e-6;
/** The place of a transform in Steradian's language; `null` for what is none, or shears. */
function placeOf(text) {
	if (text === "identity") return {
		location: [
			0,
			0,
			0
		],
		rotation: [
			0,
			0,
			0
		],
		scale: [
			1,
			1,
			1
		]
	};
	const m = /^\{matrix: \[([^[\]]*)\]\}$/.exec(text.trim())?.[1]?.split(",").map(Number);
	if (m?.length !== 16 || !m.every(Number.isFinite) || m[12] !== 0 || m[13] !== 0 || m[14] !== 0 || m[15] !== 1) return null;
	const column = (i) => [
		m[i],
		m[4 + i],
		m[8 + i]
	];
	const axes = [
		column(0),
		column(1),
		column(2)
	];
	const sizes = axes.map(length);
	if (sizes.some((s) => s === 0)) return null;
	if (dot(cross(axes[0], axes[1]), axes[2]) < 0) sizes[0] = -sizes[0];
	const [x, y, z] = axes.map((a, i) => scale(a, 1 / sizes[i]));
	if ([
		dot(x, y),
		dot(y, z),
		dot(z, x)
	].some((d) => Math.abs(d) > SHEAR)) return null;
	const sine = Math.max(-1, Math.min(1, -x[2]));
	const turns = Math.hypot(x[0], x[1]) > 1e-9 ? [
		Math.atan2(y[2], z[2]),
		Math.asin(sine),
		Math.atan2(x[1], x[0])
	] : [
		Math.atan2(-z[1], y[1]),
		Math.asin(sine),
		0
	];
	return {
		location: column(3),
		rotation: turns.map((v) => v * 180 / Math.PI),
		scale: sizes
	};
}
/** A transform in Steradian's language, and then a shift along an axis; `null` where it is not told by a matrix. */
function shifted(text, axis, distance) {
	const m = text === "identity" ? [
		1,
		0,
		0,
		0,
		0,
		1,
		0,
		0,
		0,
		0,
		1,
		0,
		0,
		0,
		0,
		1
	] : /^\{matrix: \[([^[\]]*)\]\}$/.exec(text.trim())?.[1]?.split(",").map(Number);
	if (m?.length !== 16 || !m.every(Number.isFinite)) return null;
	m[4 * axis + 3] += distance;
	return `{matrix: [${m.join(", ")}]}`;
}
/** A place in Steradian's language. */
function textOf({ location, rotation, scale: size }) {
	const [[sx, cx], [sy, cy], [sz, cz]] = rotation.map((v) => {
		const exact = [
			0,
			1,
			0,
			-1
		];
		const quarter = v / 90;
		if (Number.isInteger(quarter)) return [exact[(quarter % 4 + 4) % 4], exact[((quarter + 1) % 4 + 4) % 4]];
		return [Math.sin(v * Math.PI / 180), Math.cos(v * Math.PI / 180)];
	});
	return `{matrix: [${[
		...[
			[
				cy * cz,
				sx * sy * cz - cx * sz,
				cx * sy * cz + sx * sz
			],
			[
				cy * sz,
				sx * sy * sz + cx * cz,
				cx * sy * sz - sx * cz
			],
			[
				-sy,
				sx * cy,
				cx * cy
			]
		].flatMap((row, i) => [...row.map((v, k) => v * size[k]), location[i]]),
		0,
		0,
		0,
		1
	].join(", ")}]}`;
}
// src/placefield.ts
/** A field for a transform: location, rotation and scale, each number to be typed, or dragged by its letter. */
var PARTS = [
	"location",
	"rotation",
	"scale"
];
var AXES$1 = [
	"x",
	"y",
	"z"
];
/** `change` is called with each new place in Steradian's language; `done` is false while a number is dragged. */
function placeField(label, text, change) {
	let place = placeOf(text);
	/** By how much a pixel of dragging changes a number. */
	function step(part, axis) {
		if (part === "rotation") return .5;
		if (part === "scale") return Math.abs(place.scale[axis]) / 200;
		return Math.max(Math.hypot(...place.location), Math.hypot(...place.scale), .001) / 300;
	}
	function take(part, axis, value, done) {
		const changed = [...place[part]];
		changed[axis] = value;
		if (!Number.isFinite(value) || part === "scale" && value === 0) return show();
		place = {
			...place,
			[part]: changed
		};
		show();
		change(textOf(place), done);
	}
	function number(part, axis) {
		const name = AXES$1[axis];
		const field = h("input", {
			type: "number",
			class: "number",
			step: "any",
			required: true,
			"aria-label": `${label}, ${part} ${name}`,
			onchange: () => field.checkValidity() ? take(part, axis, field.valueAsNumber, true) : field.reportValidity()
		});
		const handle = h("span", {
			class: `axis ${name}`,
			title: "Drag to change",
			"aria-hidden": "true"
		}, name);
		handle.addEventListener("pointerdown", (down) => {
			if (down.button !== 0) return;
			down.preventDefault();
			handle.setPointerCapture(down.pointerId);
			const [from, by] = [place[part][axis], step(part, axis)];
			const at = (event) => Number((from + by * (event.clientX - down.clientX)).toPrecision(6));
			const move = (event) => take(part, axis, at(event), false);
			const end = (event) => {
				handle.removeEventListener("pointermove", move);
				handle.removeEventListener("pointerup", end);
				handle.removeEventListener("pointercancel", end);
				if (event.clientX !== down.clientX) take(part, axis, at(event), true);
			};
			handle.addEventListener("pointermove", move);
			handle.addEventListener("pointerup", end);
			handle.addEventListener("pointercancel", end);
		});
		return {
			field,
			element: h("span", { class: "axis-field" }, handle, field)
		};
	}
	const numbers = PARTS.map((part) => AXES$1.map((_, axis) => number(part, axis)));
	function show() {
		PARTS.forEach((part, i) => place[part].forEach((v, axis) => setValue(numbers[i][axis].field, String(Number(v.toPrecision(7))))));
	}
	show();
	const rows = PARTS.map((part, i) => h("div", { class: "place-row" }, h("span", { class: "part" }, part), ...numbers[i].map((n) => n.element)));
	const set = (text) => {
		const now = placeOf(text);
		if (now) place = now;
		show();
	};
	return {
		element: h("div", { class: "place" }, ...rows),
		set
	};
}
// src/parameter.ts
/** A field for a node's parameter, by its type and value. */
var NUMBER = /^[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?$/i;
/** The three numbers of a text, `[r, g, b]` or `{rgb: [r, g, b]}`, or `null`. */
function triple$1(text) {
	const parts = /^(?:\{rgb: )?\[([^[\]{}]*)\]\}?$/.exec(text.trim())?.[1]?.split(",").map((p) => p.trim());
	return parts?.length === 3 && parts.every((p) => NUMBER.test(p)) ? parts.map(Number) : null;
}
/** What holds; of a default without what is said of exceptions. */
var current = (p) => p.value ?? p.default.split(";")[0] ?? "";
function kindOf(p) {
	const text = current(p);
	if (p.type.startsWith("true or false")) return "flag";
	if (p.words.length > 0 && (p.value === null || p.words.includes(p.value))) return "word";
	if (/spectrum/.test(p.type) && triple$1(text)) return "color";
	if (/^(whole )?number/.test(p.type) && NUMBER.test(text)) return "number";
	if (p.type === "transform" && placeOf(text)) return "place";
	return "text";
}
function parameterField(p, label, edit) {
	const kind = kindOf(p);
	const make = {
		flag,
		word,
		color,
		number: number$1,
		place,
		text: text$1
	}[kind];
	return {
		kind,
		...make(p, label, edit)
	};
}
function flag(p, label, edit) {
	const box = h("input", {
		type: "checkbox",
		"aria-label": label,
		onchange: () => edit(String(box.checked), true)
	});
	const set = (p) => void (box.checked = current(p) === "true");
	set(p);
	return {
		element: box,
		set
	};
}
function word(p, label, edit) {
	const own = p.words.includes(current({
		...p,
		value: null
	})) ? [] : [h("option", { value: "" }, p.default || "–")];
	const options = p.words.map((w) => h("option", { value: w }, w));
	const select = h("select", {
		"aria-label": label,
		onchange: () => edit(select.value || null, true)
	}, ...own, ...options);
	const set = (p) => setValue(select, p.words.includes(current(p)) ? current(p) : "");
	set(p);
	return {
		element: select,
		set
	};
}
function number$1(p, label, edit) {
	const field = numberField({
		label,
		value: Number(current(p)),
		range: p.range,
		whole: p.type.startsWith("whole"),
		unit: p.unit,
		change: (v, done) => edit(String(v), done)
	});
	const set = (p) => {
		field.set(Number(current(p)));
		if (picker) setValue(picker, hexOf([
			1,
			1,
			1
		].map((v) => v * Number(current(p)))));
	};
	const isColorful = /spectrum/.test(p.type) && p.unit === "" && p.range?.[0] === 0 && p.range[1] === 1;
	const send = (picker) => edit(`[${linearOf(picker.value).join(", ")}]`, true);
	const picker = !isColorful ? null : h("input", {
		type: "color",
		"aria-label": `${label}, colour`,
		onchange: () => send(picker)
	});
	if (picker) field.element.prepend(picker);
	set(p);
	return {
		element: field.element,
		set
	};
}
function color(p, label, edit) {
	const send = (rgb, done) => edit(`[${rgb.join(", ")}]`, done);
	const take = (done) => {
		const rgb = linearOf(picker.value);
		fields.forEach((f, i) => f.value = String(rgb[i]));
		send(rgb, done);
	};
	const picker = h("input", {
		type: "color",
		"aria-label": label,
		oninput: () => take(false),
		onchange: () => take(true)
	});
	const fields = [
		"red",
		"green",
		"blue"
	].map((name) => h("input", {
		type: "number",
		class: "number",
		step: "any",
		required: true,
		"aria-label": `${label}, ${name}`,
		onchange: () => {
			const rgb = fields.map((f) => f.valueAsNumber);
			if (!rgb.every(Number.isFinite)) return;
			picker.value = hexOf(rgb);
			send(rgb, true);
		}
	}));
	const set = (p) => {
		const rgb = triple$1(current(p));
		setValue(picker, hexOf(rgb));
		fields.forEach((f, i) => setValue(f, String(rgb[i])));
	};
	set(p);
	return {
		element: h("span", { class: "color" }, picker, ...fields),
		set
	};
}
function place(p, label, edit) {
	const field = placeField(label, current(p), edit);
	return {
		element: field.element,
		set: (p) => field.set(current(p))
	};
}
function text$1(p, label, edit) {
	const field = h("input", {
		type: "text",
		spellcheck: "false",
		"aria-label": label,
		onchange: () => edit(field.value.trim() || null, true)
	});
	const set = (p) => {
		setValue(field, p.value ?? "");
		field.placeholder = p.default;
	};
	set(p);
	return {
		element: field,
		set
	};
}
// src/nodes.ts
/** Panel "Scene": what is selected, the nodes by family, and their parameters to be edited. */
/** Milliseconds after which a picture that did not come is no longer waited for. */
var PATIENCE$1 = 2e3;
var ParameterRow = class {
	edit;
	element = h("div", { class: "row parameter" });
	field = null;
	name;
	slot = h("span", { class: "slot" });
	reset;
	constructor(node, parameter, edit) {
		this.edit = edit;
		const { name } = parameter;
		this.name = h("span", {
			class: "name",
			title: [
				name,
				parameter.doc,
				parameter.type
			].filter(Boolean).join("\n")
		}, name.replaceAll("_", " "));
		const what = `What holds when ${name} is not given`;
		this.reset = h("button", {
			class: "small",
			title: what,
			"aria-label": what,
			onclick: () => edit(name, null, true)
		}, "×");
		this.label = `${node.id}: ${name}`;
		this.element.append(this.name, this.slot, this.reset);
		this.update(parameter);
	}
	label;
	update(parameter) {
		const { name, type, doc, unit } = parameter;
		this.element.title = [doc, type].filter(Boolean).join("\n");
		this.name.classList.toggle("unset", parameter.value === null);
		this.reset.hidden = parameter.value === null;
		if (this.field?.kind === kindOf(parameter)) return this.field.set(parameter);
		this.field = parameterField(parameter, this.label, (value, done) => this.edit(name, value, done));
		this.slot.replaceChildren(this.field.element);
		this.name.querySelector(".unit")?.remove();
		if (unit && this.field.kind !== "number") this.name.append(" ", h("span", { class: "unit" }, unit));
	}
};
var NodeItem = class {
	node;
	edit;
	element;
	title = h("span", { class: "kind" });
	body = h("div", { class: "body" });
	moreTitle = h("span");
	rows = null;
	constructor(node, edit) {
		this.node = node;
		this.edit = edit;
		this.element = h("details", {
			class: "node",
			ontoggle: () => this.element.open && this.fill()
		}, h("summary", {}, h("span", { class: "id" }, node.id), this.title), this.body);
		this.update(node);
	}
	update(node) {
		this.node = node;
		setText(this.title, node.kind);
		if (this.rows) this.fill();
	}
	/** Rows are made when the node is opened first. */
	fill() {
		const rows = /* @__PURE__ */ new Map();
		for (const parameter of this.node.parameters) {
			const old = this.rows?.get(parameter.name);
			old?.update(parameter);
			rows.set(parameter.name, old ?? new ParameterRow(this.node, parameter, (p, value, done) => this.edit(this.node.id, p, value, done)));
		}
		const isSame = this.rows && [...rows.keys()].join() === [...this.rows.keys()].join();
		this.rows = rows;
		const [first, more] = split(this.node);
		const set = more.filter((p) => p.value !== null).length;
		setText(this.moreTitle, `more: ${more.length} parameters${set ? `, ${set} set` : ""}`);
		if (isSame) return;
		const elements = (of) => of.map((p) => rows.get(p.name).element);
		const folded = more.length ? [h("details", { class: "more" }, h("summary", {}, this.moreTitle), ...elements(more))] : [];
		this.body.replaceChildren(...rows.size ? [...elements(first), ...folded] : [h("p", { class: "facts" }, "nothing to set")]);
	}
	unfold() {
		this.element.open = true;
		this.fill();
	}
};
var Nodes = class {
	send;
	deselect;
	element;
	undo = h("button", {
		title: "Undo (Ctrl+Z)",
		onclick: () => this.send({ type: "undo" })
	}, "Undo");
	redo = h("button", {
		title: "Redo (Ctrl+Shift+Z)",
		onclick: () => this.send({ type: "redo" })
	}, "Redo");
	filter = h("input", {
		type: "search",
		placeholder: "Filter",
		"aria-label": "Filter the nodes",
		oninput: () => this.sift()
	});
	chosen = h("div", {
		class: "chosen",
		role: "group",
		"aria-label": "Selected",
		hidden: true
	});
	list = h("div", { class: "nodes" });
	items = /* @__PURE__ */ new Map();
	nodes = [];
	selected = null;
	/** Whether what is selected is still to be scrolled to. */
	reveals = false;
	/** Where the shape was that is dragged. */
	base = null;
	key = "";
	wants = false;
	/** The edit of a slider that is held, until it is sent. */
	held = null;
	sentAt = -2e3;
	/** Edits that were sent. */
	edits = 0;
	constructor(send, deselect) {
		this.send = send;
		this.deselect = deselect;
		this.element = section("Scene", false, h("div", { class: "buttons" }, this.undo, this.redo, this.filter), this.chosen, this.list);
		this.element.addEventListener("toggle", () => void this.load());
	}
	/** Something else may be in the scene now. */
	update({ undo, redo, scene }, connected) {
		this.undo.disabled = undo === 0;
		this.redo.disabled = redo === 0;
		const key = `${undo} ${redo} ${scene.path} ${scene.name} ${scene.faces} ${scene.materials} ${scene.lights}`;
		if (key === this.key && !this.wants && !connected) return;
		this.key = key;
		this.wants = true;
		this.load();
	}
	async load() {
		if (!this.wants || !this.element.open) return;
		this.wants = false;
		const { edits } = this;
		try {
			const response = await fetch("./api/nodes");
			const nodes = await response.json();
			if (edits !== this.edits) this.wants = true;
			else if (response.ok) this.show(nodes);
		} catch {
			this.wants = true;
		}
	}
	show(nodes) {
		this.nodes = nodes;
		for (const node of nodes) this.items.get(node.id)?.update(node);
		this.arrange();
		this.reveal();
	}
	/** What is selected stands above the others. */
	select(selected) {
		this.selected = selected;
		this.arrange();
		this.reveals = selected !== null;
		if (!selected) return;
		this.element.open = true;
		if (this.wants) this.load();
		else this.reveal();
	}
	/** The nodes that are selected: the shape, its light and its material. */
	chosenIds() {
		const { shape, light, material } = this.selected ?? {};
		return [
			shape,
			light,
			material
		].filter((id) => typeof id === "string" && this.items.has(id));
	}
	reveal() {
		if (!this.reveals || this.wants || this.chosen.hidden) return;
		this.reveals = false;
		this.items.get(this.chosenIds().at(-1))?.unfold();
		this.chosen.scrollIntoView({ block: "start" });
	}
	arrange() {
		const old = new Map(this.items);
		this.items.clear();
		for (const node of this.nodes) this.items.set(node.id, old.get(node.id) ?? new NodeItem(node, (...edit) => this.edit(...edit)));
		const chosen = this.chosenIds();
		const shape = JSON.stringify([chosen, this.nodes.map((n) => [n.family, n.id])]);
		if (this.list.dataset.shape === shape) return;
		this.list.dataset.shape = shape;
		const families = /* @__PURE__ */ new Map();
		for (const node of this.nodes.filter((n) => !chosen.includes(n.id))) families.set(node.family, [...families.get(node.family) ?? [], node]);
		const folds = new Map([...this.list.querySelectorAll(".family")].map((f) => [f.dataset.family, f.open]));
		this.list.replaceChildren(...[...families].map(([family, members]) => h("details", {
			class: "family",
			"data-family": family,
			open: folds.get(family) ?? members.length <= 12
		}, h("summary", {}, h("h3", {}, family), h("span", { class: "kind" }, String(members.length))), ...members.map((n) => this.items.get(n.id).element))));
		this.choose(chosen);
		this.sift();
	}
	choose(chosen) {
		this.chosen.hidden = chosen.length === 0;
		const what = "Select nothing (Escape)";
		const close = h("button", {
			class: "small",
			title: what,
			"aria-label": what,
			onclick: () => this.deselect()
		}, "×");
		const head = h("div", { class: "pin-head" }, h("strong", {}, `Selected: ${chosen[0] ?? ""}`), close);
		this.chosen.replaceChildren(...chosen.length ? [head, ...chosen.map((id) => this.items.get(id).element)] : []);
	}
	/** Moves the selected shape along an axis, by a distance from where it was before this began. */
	shift(axis, distance, done) {
		const shape = this.selected?.shape;
		if (shape === void 0) return;
		if (this.wants && this.base === null) this.element.open = true;
		else this.base ??= this.nodes.find((n) => n.id === shape)?.parameters.find((p) => p.name === "to_world")?.value ?? "identity";
		const value = this.base === null ? null : shifted(this.base, axis, distance);
		if (done) this.base = null;
		if (value !== null) this.edit(shape, "to_world", value, done);
	}
	/** Sends an edit; while a slider is held only when the picture of the last one came. */
	edit(node, parameter, value, done) {
		if (!done) {
			this.held = {
				type: "edit",
				node,
				parameter,
				value,
				moving: true
			};
			this.sendHeld();
			return;
		}
		this.held = null;
		this.wants = true;
		this.edits++;
		this.send({
			type: "edit",
			node,
			parameter,
			value,
			moving: false
		});
	}
	sendHeld() {
		if (this.held === null || performance.now() - this.sentAt < PATIENCE$1) return;
		this.edits++;
		this.send(this.held);
		this.held = null;
		this.sentAt = performance.now();
	}
	/** A picture came. */
	frame() {
		this.sentAt = -2e3;
		this.sendHeld();
	}
	/** Shows the nodes whose id or kind has the filter's text. */
	sift() {
		const text = this.filter.value.trim().toLowerCase();
		const chosen = this.chosenIds();
		for (const { element, node } of this.items.values()) element.hidden = text !== "" && !chosen.includes(node.id) && !`${node.id} ${node.kind}`.toLowerCase().includes(text);
		for (const family of this.list.children) family.toggleAttribute("hidden", ![...family.querySelectorAll(".node")].some((n) => !n.hidden));
	}
};
// src/output.ts
/** Panel "Save": files to download or to write beside the scene, and the command that renders the same. */
/** What stands for the scene among files that can be saved. */
var SCENE = "scene.steradian";
var Output = class {
	view;
	tell;
	element;
	exr = h("a", {
		class: "button",
		download: "picture.exr",
		href: "./api/picture.exr",
		title: "All values, with the layer that is shown"
	}, "EXR");
	png = h("a", {
		class: "button",
		download: "picture.png",
		href: "./api/picture.png"
	}, "PNG");
	scene = h("a", {
		class: "button",
		download: "scene.steradian",
		href: "./api/scene.steradian",
		title: "The scene as it is now"
	}, "Scene");
	command = h("code", {
		class: "command",
		tabindex: 0,
		"aria-label": "Command that renders this picture",
		role: "textbox",
		"aria-readonly": "true"
	});
	state = null;
	constructor(view, tell) {
		this.view = view;
		this.tell = tell;
		this.element = section("Save", false, h("div", { class: "row" }, h("span", {}, "Download"), h("span", { class: "buttons" }, this.exr, this.png, this.scene)), h("div", { class: "row" }, h("span", {}, "Beside scene"), h("span", { class: "buttons" }, ...[
			"picture.exr",
			"picture.png",
			SCENE
		].map((name) => h("button", {
			title: name === SCENE ? "Write the scene as it is now into its folder" : `Write ${name} into the scene’s folder`,
			onclick: () => void this.save(name === SCENE ? this.state?.saveName ?? SCENE : name)
		}, name.endsWith("steradian") ? "Scene" : name.slice(-3).toUpperCase())))), this.command, h("div", { class: "buttons" }, h("button", { onclick: () => void this.copy() }, "Copy command")));
	}
	update(state = this.state) {
		this.state = state;
		if (!state) return;
		const layers = [...state.layers, ...state.settings.lightGroups ? ["light_groups"] : []];
		this.exr.href = `./api/picture.exr${layers.length ? `?layers=${layers.join(",")}` : ""}`;
		this.scene.download = state.saveName;
		this.png.href = `./api/picture.png?${new URLSearchParams(this.look())}`;
		if (this.command.textContent !== state.command) this.command.textContent = state.command;
	}
	/** Tone and exposure as the view has them. */
	look() {
		return {
			tone: toneText(this.view.tone, this.state?.choices.tones ?? []),
			exposure: String(this.view.tone.exposure)
		};
	}
	async save(name) {
		const { tone, exposure } = this.look();
		const body = JSON.stringify(name.endsWith(".png") ? {
			name,
			tone,
			exposure: Number(exposure)
		} : { name });
		try {
			const response = await fetch("./api/save", {
				method: "POST",
				headers: { "content-type": "application/json" },
				body
			});
			const answer = await response.json();
			this.tell(answer.saved ? {
				severity: "note",
				text: `saved ${answer.saved}`
			} : {
				severity: "error",
				text: answer.error ?? response.statusText
			});
		} catch {
			this.tell({
				severity: "error",
				text: `${name} was not saved: the server does not answer`
			});
		}
	}
	/** Copies a command, by default that of the picture. */
	async copy(text = this.state?.command ?? "") {
		try {
			await navigator.clipboard.writeText(text);
			this.tell({
				severity: "note",
				text: "command copied"
			});
		} catch {
			getSelection()?.selectAllChildren(this.command);
			this.tell({
				severity: "warning",
				text: "the browser does not let the page copy; the command is selected instead"
			});
		}
	}
};
// src/bookmarks.ts
/** Viewpoints that are kept in the browser, for each scene. */
/** Viewpoints of a scene at most. */
var MOST$1 = 32;
var Bookmarks = class {
	send;
	element;
	list = h("select", {
		"aria-label": "Kept viewpoints",
		onchange: () => this.go()
	});
	keep = h("button", {
		title: "Keep this viewpoint in the browser",
		onclick: () => this.add()
	}, "Keep");
	forget = h("button", {
		title: "Forget the chosen viewpoint",
		onclick: () => this.remove()
	}, "Forget");
	key = "";
	camera = null;
	constructor(send) {
		this.send = send;
		this.element = h("div", {}, row("Viewpoints", this.list), h("div", { class: "buttons" }, this.keep, this.forget));
	}
	update(scene, camera) {
		this.key = `viewpoints of ${scene}`;
		this.camera = camera;
		const kept = this.kept();
		this.element.hidden = !camera.movable;
		const place = ({ eye }) => eye.map(show).join(", ");
		setOptions(this.list, [{
			value: "",
			text: "–"
		}, ...kept.map((view, i) => ({
			value: String(i),
			text: `${i + 1}: from ${place(view)}`
		}))]);
		const at = kept.findIndex((view) => same(view, camera));
		this.list.value = at < 0 ? "" : String(at);
		this.list.disabled = kept.length === 0;
		this.keep.disabled = at >= 0 || kept.length >= MOST$1;
		this.forget.disabled = at < 0;
	}
	add() {
		if (!this.camera) return;
		const { eye, target, up, fov } = this.camera;
		this.store([...this.kept(), {
			eye,
			target,
			up,
			fov
		}]);
	}
	remove() {
		const at = Number(this.list.value);
		if (this.list.value !== "") this.store(this.kept().filter((_, i) => i !== at));
	}
	go() {
		const view = this.kept()[Number(this.list.value)];
		if (this.list.value === "" || !view) return;
		const { eye, target, up, fov } = view;
		this.send({
			type: "camera",
			eye,
			target,
			up,
			...fov === null ? {} : { fov },
			moving: false
		});
	}
	kept() {
		try {
			const kept = JSON.parse(localStorage.getItem(this.key) ?? "[]");
			return Array.isArray(kept) ? kept.filter((view) => Array.isArray(view?.eye)) : [];
		} catch {
			return [];
		}
	}
	store(views) {
		try {
			localStorage.setItem(this.key, JSON.stringify(views));
		} catch {}
		if (this.camera) this.update(this.key.slice(14), this.camera);
	}
};
/** Whether two viewpoints are one but for the last digits, which the way to the server and back may change. */
function same(a, b) {
	const numbers = ({ eye, target, up, fov }) => [
		...eye,
		...target,
		...up,
		fov ?? 0
	];
	const [p, q] = [numbers(a), numbers(b)];
	return p.every((v, i) => Math.abs(v - q[i]) <= 1e-9 * (1 + Math.abs(v)));
}
// src/panel.ts
/** Panels "Render" and "Camera": what the server is asked to render. */
/** A field for a whole number of the settings; empty for none where `optional`. */
function whole(label, low, optional, change) {
	const field = h("input", {
		type: "number",
		class: "number",
		min: low,
		step: 1,
		required: !optional,
		"aria-label": label,
		placeholder: optional ? "default" : null,
		onchange: () => {
			if (field.checkValidity()) change(field.value === "" ? null : field.valueAsNumber);
			else field.reportValidity();
		}
	});
	return field;
}
var RenderPanel = class {
	send;
	element;
	choices;
	spp;
	seed;
	depth;
	width;
	height;
	constructor(send) {
		this.send = send;
		const set = (change) => this.send({
			type: "settings",
			...change
		});
		const choice = (key, label) => {
			const select = h("select", {
				"aria-label": label,
				onchange: () => set({ [key]: select.value || null })
			});
			return select;
		};
		this.choices = {
			integrator: choice("integrator", "Integrator"),
			sampler: choice("sampler", "Sampler"),
			color: choice("color", "Colour"),
			denoise: choice("denoise", "Denoise")
		};
		this.spp = whole("Samples per pixel", 1, false, (v) => set({ spp: v }));
		this.seed = whole("Seed", 0, true, (v) => set({ seed: v }));
		this.depth = whole("Most bounces", 0, true, (v) => set({ maxDepth: v }));
		this.width = whole("Width in pixels", 1, false, () => set(this.size()));
		this.height = whole("Height in pixels", 1, false, () => set(this.size()));
		const size = h("span", { class: "plain" }, this.width, "×", this.height);
		this.element = section("Render", true, row("Integrator", this.choices.integrator), row("Samples", this.spp, "Samples for each pixel"), row("Sampler", this.choices.sampler), row("Colour", this.choices.color), h("div", { class: "row" }, h("span", {}, "Size"), size), row("Seed", this.seed), row("Max depth", this.depth, "Bounces at most"), row("Denoise", this.choices.denoise));
	}
	update({ settings, choices, film }) {
		const named = (list) => list.map((c) => ({
			value: c.name,
			title: c.doc
		}));
		const { integrator } = settings;
		const own = choices.integrators.some((c) => c.name === integrator) ? [] : [{
			value: integrator,
			text: integrator || "the scene’s"
		}];
		setOptions(this.choices.integrator, [...own, ...named(choices.integrators)]);
		setOptions(this.choices.sampler, [{
			value: "",
			text: "automatic"
		}, ...named(choices.samplers)]);
		setOptions(this.choices.color, choices.colors.map((value) => ({ value })));
		setOptions(this.choices.denoise, [{
			value: "",
			text: "no"
		}, ...named(choices.denoisers)]);
		for (const key of [
			"integrator",
			"sampler",
			"color",
			"denoise"
		]) {
			const select = this.choices[key];
			setValue(select, settings[key] ?? "");
			select.title = select.selectedOptions[0]?.title ?? "";
		}
		setValue(this.spp, String(settings.spp));
		setValue(this.seed, settings.seed === null ? "" : String(settings.seed));
		setValue(this.depth, settings.maxDepth === null ? "" : String(settings.maxDepth));
		setValue(this.width, String(film.width));
		setValue(this.height, String(film.height));
	}
	size() {
		return {
			width: this.width.valueAsNumber,
			height: this.height.valueAsNumber
		};
	}
};
var CameraPanel = class {
	send;
	element;
	names = h("select", {
		"aria-label": "Camera",
		onchange: () => this.send({
			type: "camera-name",
			name: this.names.value
		})
	});
	nameRow = row("Camera", this.names);
	facts = h("p", { class: "facts" });
	buttons;
	fovRow;
	fov;
	bookmarks;
	constructor(send, actions) {
		this.send = send;
		const button = (text, title, act) => h("button", {
			title,
			onclick: act
		}, text);
		this.buttons = [
			button("Reset", "Back to the scene’s camera (Home)", () => this.send({ type: "camera-reset" })),
			button("Front", "From the front (Numpad 1)", () => actions.from("front")),
			button("Right", "From the right (Numpad 3)", () => actions.from("right")),
			button("Top", "From above (Numpad 7)", () => actions.from("top")),
			button("Fly", "Fly with W A S D Q E and the mouse (Shift+`)", () => actions.fly())
		];
		this.fov = numberField({
			label: "Angle of view",
			value: 50,
			range: [.01, 179],
			slider: [5, 150],
			step: .5,
			unit: "°",
			change: actions.fov
		});
		this.fovRow = row("Angle of view", this.fov.element);
		this.bookmarks = new Bookmarks(send);
		const buttons = h("div", { class: "buttons" }, ...this.buttons);
		this.element = section("Camera", false, this.nameRow, this.fovRow, buttons, this.bookmarks.element, this.facts);
	}
	update({ camera, scene }) {
		this.bookmarks.update(scene.path ?? scene.name, camera);
		this.nameRow.hidden = camera.names.length < 2;
		setOptions(this.names, camera.names.map((value) => ({ value })));
		if (camera.name !== null) setValue(this.names, camera.name);
		for (const button of this.buttons) button.disabled = !camera.movable;
		this.buttons[0].disabled = !camera.moved;
		this.fovRow.hidden = camera.fov === null || !camera.movable;
		if (camera.fov !== null) this.fov.set(camera.fov);
		const place = (v) => v.map(show).join(", ");
		const fixed = camera.movable ? "" : "; it cannot be moved here";
		this.facts.textContent = `${camera.kind}, from ${place(camera.eye)} to ${place(camera.target)}${fixed}`;
	}
};
// src/surroundings.ts
/** Panel "Surroundings": light, ground and background of a model or glTF scene, and the moment of its animation. */
/** Frames of a second while an animation plays. */
var RATE = 24;
/** The colour that a background of one begins with. */
var BACKGROUND = "#ffffff";
var SurroundingsPanel = class {
	send;
	copy;
	element;
	sky = this.choice("sky", "Sky");
	background = h("select", {
		"aria-label": "Background",
		onchange: () => this.setBackground(this.background.value)
	});
	color = h("input", {
		type: "color",
		value: BACKGROUND,
		"aria-label": "Colour of the background",
		onchange: () => this.define("background", this.color.value)
	});
	turn = numberField({
		label: "Turn of the sky in degrees",
		value: 0,
		range: [-360, 360],
		slider: [-180, 180],
		step: 1,
		unit: "°",
		change: (v, done) => this.define("turn", v === 0 ? null : String(v), !done)
	});
	strength = numberField({
		label: "Strength of the sky",
		value: 1,
		range: [0, 1e6],
		slider: [.01, 100],
		change: (v, done) => this.define("strength", v === 1 ? null : String(v), !done)
	});
	ground = h("input", {
		type: "checkbox",
		"aria-label": "Ground",
		onchange: () => this.define("ground", String(this.ground.checked))
	});
	material = this.choice("material", "Material of all");
	materialRow = row("Material", this.material, "A finish for a model, in place of its own materials");
	animation = this.choice("animation", "Animation");
	time = h("input", {
		type: "range",
		step: .001,
		"aria-label": "Time in seconds"
	});
	seconds = h("output", {});
	play = h("button", {
		class: "small",
		"aria-pressed": "false",
		onclick: () => this.setPlaying(!isPressed(this.play))
	}, "Play");
	moment = h("div", {}, row("Animation", this.animation), row("Time", this.time), h("div", { class: "buttons" }, this.play, this.seconds));
	/** Edited scenes are saved in a form that has a camera of its own: there is no turntable of those. */
	copyFilm = h("button", { onclick: () => void this.copy(this.film()) }, "Copy turntable command");
	surroundings = null;
	command = "";
	sentAt = null;
	began = 0;
	constructor(send, copy) {
		this.send = send;
		this.copy = copy;
		this.time.addEventListener("input", () => this.pose(this.time.valueAsNumber, true));
		this.time.addEventListener("change", () => this.pose(this.time.valueAsNumber, false));
		this.element = section("Surroundings", false, row("Sky", this.sky, "Light from all sides; a dropped picture takes its place"), row("Turn", this.turn.element, "The sky, turned to the right"), row("Strength", this.strength.element, "Factor on the light of the sky"), row("Ground", this.ground), row("Background", h("span", { class: "plain" }, this.background, this.color), "Behind the scene; the light stays that of the sky"), this.materialRow, this.moment, h("div", { class: "buttons" }, this.copyFilm));
	}
	update(state) {
		const { surroundings } = state;
		this.surroundings = surroundings;
		this.element.hidden = surroundings === null;
		this.command = state.command;
		this.copyFilm.disabled = state.undo > 0;
		if (!surroundings) return this.setPlaying(false);
		const { defines, skies, backgrounds, finishes, animations } = surroundings;
		setOptions(this.sky, [{
			value: "",
			text: "usual"
		}, ...withOwn(skies, defines["sky"])]);
		setValue(this.sky, defines["sky"] ?? "");
		this.turn.set(Number(defines["turn"] ?? 0));
		this.strength.set(Number(defines["strength"] ?? 1));
		this.ground.checked = defines["ground"] !== "false";
		const isColor = defines["background"] !== void 0 && !backgrounds.includes(defines["background"]);
		setOptions(this.background, [...backgrounds.map((value) => ({ value })), { value: "colour" }]);
		setValue(this.background, isColor ? "colour" : defines["background"] ?? "sky");
		this.color.hidden = !isColor;
		if (isColor && defines["background"].startsWith("#")) setValue(this.color, defines["background"]);
		this.materialRow.hidden = finishes.length === 0;
		setOptions(this.material, [{
			value: "",
			text: "its own"
		}, ...withOwn(finishes, defines["material"])]);
		setValue(this.material, defines["material"] ?? "");
		this.moment.hidden = animations.length === 0;
		const names = animations.map((a, i) => ({
			value: i === 0 ? "" : a.name ?? String(i),
			text: a.name ?? `animation ${i}`
		}));
		setOptions(this.animation, names);
		setValue(this.animation, defines["animation"] ?? "");
		const [from, to] = this.times();
		Object.assign(this.time, {
			min: String(from),
			max: String(to)
		});
		const at = Number(defines["at"] ?? from);
		if (!isPressed(this.play)) setValue(this.time, String(at));
		this.seconds.textContent = `${show(at)} s`;
	}
	/** A picture came: the next moment may be asked for. */
	frame() {
		if (this.sentAt === null || !isPressed(this.play)) return;
		const next = Math.max(0, this.sentAt + 1e3 / RATE - performance.now());
		this.sentAt = null;
		window.setTimeout(() => this.step(), next);
	}
	setPlaying(on) {
		if (on === isPressed(this.play)) return;
		setPressed(this.play, on);
		this.play.textContent = on ? "Stop" : "Play";
		if (!on) {
			this.sentAt = null;
			if (this.surroundings) this.pose(this.time.valueAsNumber, false);
			return;
		}
		const [from, to] = this.times();
		const at = this.time.valueAsNumber;
		this.began = performance.now() - 1e3 * (at < to ? at - from : 0);
		this.step();
	}
	/** The moment that plays now: the animation is repeated. */
	step() {
		if (!isPressed(this.play)) return;
		const [from, to] = this.times();
		const length = Math.max(to - from, 1 / RATE);
		const at = from + (performance.now() - this.began) / 1e3 % length;
		this.time.value = String(at);
		this.sentAt = performance.now();
		this.pose(this.time.valueAsNumber, true);
	}
	pose(at, moving) {
		this.seconds.textContent = `${show(at)} s`;
		this.define("at", String(at), moving);
	}
	/** Times of the first and last key frame of the animation. */
	times() {
		const { animations = [], defines = {} } = this.surroundings ?? {};
		return (animations.find((a, i) => (a.name ?? String(i)) === defines["animation"]) ?? animations[0])?.times ?? [0, 0];
	}
	setBackground(word) {
		this.define("background", word === "colour" ? this.color.value : word === "sky" ? null : word);
	}
	choice(name, label) {
		const select = h("select", {
			"aria-label": label,
			onchange: () => this.define(name, select.value || null)
		});
		return select;
	}
	define(name, value, moving = false) {
		this.send({
			type: "define",
			name,
			value,
			moving
		});
	}
	/** The command of a film of the scene that turns once, which places the camera and shows one moment. */
	film() {
		return `${this.command.replace(/ (--look-at|--camera) ('[^']*'|\S+)/g, "").replace(/ -D at=\S+/, "")} --turntable 96 -o turntable.gif`;
	}
};
/** Words, and the one that the program was started with. */
function withOwn(words, own) {
	return [...words, ...own === void 0 || words.includes(own) ? [] : [own]].map((value) => ({ value }));
}
// src/panels.ts
/** The panels beside the picture. */
var Panels = class {
	stage;
	element;
	look;
	compare;
	messages = new Messages();
	errors;
	histogram = new Histogram();
	render;
	surroundings;
	mixer;
	camera;
	nodes;
	output;
	constructor(stage) {
		this.stage = stage;
		const { view, send } = stage;
		this.output = new Output(view, this.tell);
		this.compare = new Compare(view, this.tell);
		this.errors = new Errors(view);
		this.compare.changed = () => this.errors.changeReference();
		this.look = new Look(view, (names) => send({
			type: "layers",
			names
		}), () => {
			this.output.update();
			this.showHistogram();
			this.compare.refresh();
		});
		this.histogram.element.addEventListener("toggle", this.showHistogram);
		this.render = new RenderPanel(send);
		this.surroundings = new SurroundingsPanel(send, (text) => this.output.copy(text));
		this.mixer = new Mixer(view, send, this.showHistogram);
		this.camera = new CameraPanel(send, {
			from: stage.from,
			fly: stage.fly,
			fov: (degrees) => stage.moving.fov(degrees)
		});
		this.nodes = new Nodes(send, () => stage.selection.set(null));
		stage.overlay.gizmo.moved = (axis, distance, done) => this.nodes.shift(axis, distance, done);
		stage.selection.changed = (selected) => this.nodes.select(selected);
		this.element = h("aside", {
			class: "panel",
			"aria-label": "Panels"
		}, this.look.element, this.compare.element, this.errors.element, this.histogram.element, stage.inspector.element, this.render.element, this.surroundings.element, this.mixer.element, this.camera.element, this.nodes.element, this.output.element, this.messages.element);
		stage.themed = this.showHistogram;
		this.showHistogram();
	}
	tell = (message) => this.messages.add(message);
	showHistogram = () => this.histogram.update(() => this.stage.view.statistics(), this.stage.view.tone.exposure);
	takeState(state) {
		this.look.update(state);
		this.compare.takeState(state);
		this.errors.takeState(state);
		this.output.update(state);
		this.messages.scene(state.scene.messages);
	}
	takeFields(state, isNew) {
		this.render.update(state);
		this.surroundings.update(state);
		this.mixer.update(state);
		this.camera.update(state);
		this.nodes.update(state, isNew);
	}
	takeFrame(frame) {
		this.look.takeFrame();
		this.mixer.takeFrame(frame);
		this.nodes.frame();
		this.surroundings.frame();
		this.compare.takeFrame(frame);
		this.errors.takeFrame(frame);
		this.showHistogram();
	}
};
// src/camera.ts
var RADIANS_PER_PIXEL = .007;
var Camera = class {
	eye = [
		0,
		0,
		1
	];
	target = [
		0,
		0,
		0
	];
	/** What is up in the scene, a unit vector. */
	axis = [
		0,
		1,
		0
	];
	handedness = 1;
	fov = 50;
	/** Where the camera looks, level. */
	heading = [
		0,
		0,
		-1
	];
	/** Where it looks after `aim`. */
	direction = [
		0,
		0,
		-1
	];
	/** Takes the server's camera. The axis stays where that camera's horizon is level about it. */
	adopt(state) {
		this.eye = [...state.eye];
		this.target = [...state.target];
		this.handedness = state.handedness;
		this.fov = state.fov ?? 50;
		const up = normalize(state.up);
		const right = normalize(cross(this.forward, up));
		const isLevel = (axis) => Math.abs(dot(right, axis)) < .001 && dot(up, axis) > -.001;
		if (!isLevel(this.axis) || Math.abs(dot(up, this.axis)) < .001) {
			const level = [
				[
					0,
					1,
					0
				],
				[
					0,
					0,
					1
				],
				[
					1,
					0,
					0
				],
				[
					0,
					-1,
					0
				],
				[
					0,
					0,
					-1
				],
				[
					-1,
					0,
					0
				]
			].filter(isLevel).sort((a, b) => dot(up, b) - dot(up, a));
			const isAcross = Math.abs(dot(up, this.forward)) < 1e-4;
			this.axis = isAcross && level[0] && dot(up, level[0]) > .1 ? level[0] : up;
		}
		const level = across(this.forward, this.axis);
		this.heading = length(level) > 1e-4 ? normalize(level) : normalize(across(scale(up, -Math.sign(dot(this.forward, this.axis))), this.axis));
	}
	get forward() {
		return normalize(sub(this.target, this.eye));
	}
	get distance() {
		return length(sub(this.target, this.eye)) || 1;
	}
	/** The picture's up direction; the axis, unless the camera looks nearly along it. */
	get up() {
		const sine = dot(this.forward, this.axis);
		if (Math.abs(sine) < .999) return this.axis;
		return add(scale(this.heading, -sine), scale(this.axis, Math.sqrt(Math.max(0, 1 - sine * sine))));
	}
	/** The picture's right direction. */
	get right() {
		return scale(normalize(cross(this.forward, this.up)), this.handedness);
	}
	/** Turns about the target: what is in front follows the pointer. Lengths in CSS pixels. */
	orbit(dx, dy) {
		const { distance } = this;
		this.aim(-this.handedness * dx * RADIANS_PER_PIXEL, -dy * RADIANS_PER_PIXEL);
		this.eye = sub(this.target, scale(this.direction, distance));
	}
	/** Turns about the eye: the view follows the pointer. */
	look(dx, dy) {
		const { distance } = this;
		this.aim(-this.handedness * dx * .5 * RADIANS_PER_PIXEL, -dy * .5 * RADIANS_PER_PIXEL);
		this.target = add(this.eye, scale(this.direction, distance));
	}
	/** Moves across the view; `size` is the picture's smaller side in the pixels that `dx` and `dy` are in. */
	pan(dx, dy, size) {
		const perPixel = 2 * this.distance * Math.tan(this.fov * Math.PI / 360) / Math.max(size, 1);
		const pictureUp = scale(cross(this.right, this.forward), this.handedness);
		this.move(add(scale(this.right, -dx * perPixel), scale(pictureUp, dy * perPixel)));
	}
	/** Changes the distance by a factor. */
	dolly(factor) {
		const distance = Math.min(Math.max(this.distance * factor, 1e-6), 1e9);
		this.eye = sub(this.target, scale(this.forward, distance));
	}
	/** Looks at a point, and turns about it from then on. */
	center(point) {
		const level = across(this.forward, this.axis);
		if (length(level) > 1e-4) this.heading = normalize(level);
		this.target = [...point];
	}
	move(by) {
		this.eye = add(this.eye, by);
		this.target = add(this.target, by);
	}
	/** Looks at the target from the front, the right or the top, or opposite. With Z up the front is at −Y, else at +Z. */
	from(side, opposite) {
		const { distance, axis } = this;
		const s = opposite ? -1 : 1;
		const isZ = Math.abs(axis[2]) > .9;
		const level = (v) => normalize(across(length(across(v, axis)) > .1 ? v : [
			0,
			0,
			1
		], axis));
		const front = level(isZ ? [
			0,
			-1,
			0
		] : [
			0,
			0,
			1
		]);
		const away = side === "top" ? axis : side === "front" ? front : level([
			1,
			0,
			0
		]);
		this.heading = side === "top" ? scale(front, -1) : scale(away, -s);
		this.eye = add(this.target, scale(away, s * distance));
	}
	/** Turns the direction by angles about the axis and towards it, and keeps it from passing the axis. */
	aim(around, upwards) {
		const sine = Math.min(Math.max(dot(this.forward, this.axis), -1), 1);
		const level = across(this.forward, this.axis);
		if (length(level) > 1e-4) this.heading = normalize(level);
		this.heading = normalize(turn(this.heading, this.axis, around));
		const tilt = Math.min(Math.max(Math.asin(sine) + upwards, -Math.PI / 2), Math.PI / 2);
		this.direction = add(scale(this.heading, Math.cos(tilt)), scale(this.axis, Math.sin(tilt)));
	}
};
// src/falsecolor.ts
/** False colour of luminance, as crates/image/src/false_color has it: viridis on a logarithmic scale, and its legend. */
/** Every fifth of viridis' 256 colours (N. Smith and S. van der Walt 2015, CC0), sRGB. */
var COLORS$1 = [
	4456788,
	4589660,
	4657251,
	4724585,
	4726127,
	4727925,
	4663930,
	4599934,
	4536193,
	4406660,
	4276871,
	4147337,
	4017802,
	3822475,
	3692940,
	3497613,
	3367821,
	3238030,
	3042702,
	2912654,
	2782862,
	2718606,
	2588814,
	2458766,
	2328974,
	2199181,
	2134668,
	2070411,
	2006153,
	2072968,
	2205061,
	2402947,
	2666112,
	3060604,
	3520377,
	4045940,
	4636783,
	5293162,
	5949540,
	6671198,
	7393111,
	8180304,
	9033032,
	9820224,
	10672695,
	11590959,
	12443430,
	13295903,
	14213657,
	15066137,
	15852829,
	16639781
];
/** Red, green and blue of a colour. */
var bytes = (c) => [
	c >> 16,
	c >> 8 & 255,
	c & 255
];
/** `falseColor(luminance)`: between the ends of the scale. */
var FALSE_COLOR_GLSL = `
uniform vec2 scaleEnds;
const vec3 viridis[52] = vec3[52](${COLORS$1.map((c) => `vec3(${bytes(c).map((v) => `${v}.0`).join(", ")})`).join(", ")});

vec3 falseColor(float l) {
  float t = l > 0.0 ? clamp(log(l / scaleEnds.x) / log(scaleEnds.y / scaleEnds.x), 0.0, 1.0) : 0.0;
  int i = min(int(t * 51.0), 50);
  return floor(mix(viridis[i], viridis[i + 1], t * 51.0 - float(i)) + 0.5) / 255.0;
}
`;
/** The scale's ends: 1 % and 99.9 % of the pixels above zero, or a decade where those are the same. */
function scaleEnds(of) {
	const low = percentile(of, .01) ?? 1;
	const high = percentile(of, .999) ?? 1;
	return low < high ? [low, high] : [low, 10 * low];
}
/** The scale of false colour: powers of ten (with 2 and 5 where few). */
function falseScale(ends, white, unit) {
	const [low, high] = [ends[0] * white, ends[1] * white];
	const place = (v) => Math.log(v / low) / Math.log(high / low);
	const ticks = ticksOf(low, high).map((v) => [place(v), show(v)]);
	return {
		label: `False colour from ${show(low)} to ${show(high)} ${unit}`,
		unit: unit || "value",
		colors: COLORS$1,
		ticks
	};
}
var Legend = class {
	element = h("div", {
		class: "legend",
		hidden: true,
		role: "img"
	});
	update(scale) {
		this.element.hidden = scale === null;
		if (!scale || this.element.getAttribute("aria-label") === scale.label) return;
		this.element.setAttribute("aria-label", scale.label);
		const bar = h("div", {
			class: "bar",
			style: `background: linear-gradient(to top, ${scale.colors.map((c) => `rgb(${bytes(c).join(" ")})`).join(", ")})`
		});
		const ticks = scale.ticks.map(([place, text]) => h("span", { style: `bottom: ${100 * place}%` }, text));
		this.element.replaceChildren(h("div", { class: "unit" }, scale.unit), h("div", { class: "scale" }, bar, h("div", { class: "ticks" }, ...ticks)));
	}
};
function ticksOf(low, high) {
	const decades = Math.log10(high / low);
	const step = Math.max(1, Math.ceil(decades / 8));
	const factors = decades > 3 ? [1] : decades > 1.5 ? [1, 3] : [
		1,
		2,
		5
	];
	const ticks = [];
	for (let e = Math.floor(Math.log10(low)); e <= Math.log10(high); e += step) for (const f of factors) if (f * 10 ** e >= low && f * 10 ** e <= high) ticks.push(f * 10 ** e);
	return ticks.length > 1 ? ticks : [low, high];
}
// src/fly.ts
/** Distances to the target for each second. */
var SPEED = .7;
var Fly = class {
	canvas;
	camera;
	moving;
	/** Called when flying begins or ends. */
	changed = () => {};
	isOn = false;
	held = /* @__PURE__ */ new Set();
	last = 0;
	speed = 1;
	constructor(canvas, camera, moving) {
		this.canvas = canvas;
		this.camera = camera;
		this.moving = moving;
		addEventListener("keydown", (event) => this.key(event, true), { capture: true });
		addEventListener("keyup", (event) => this.key(event, false), { capture: true });
		addEventListener("blur", () => this.held.clear());
		document.addEventListener("pointerlockchange", () => document.pointerLockElement === null && this.stop());
	}
	get on() {
		return this.isOn;
	}
	start() {
		if (this.isOn) return;
		this.isOn = true;
		this.speed = SPEED * this.camera.distance;
		this.last = performance.now();
		Promise.resolve(this.canvas.requestPointerLock?.()).catch(() => {});
		this.changed(true);
		requestAnimationFrame((time) => this.step(time));
	}
	stop() {
		if (!this.isOn) return;
		this.isOn = false;
		this.held.clear();
		if (document.pointerLockElement) document.exitPointerLock();
		this.moving.stop();
		this.changed(false);
	}
	look(dx, dy) {
		this.camera.look(dx, dy);
		this.moving.moved();
		this.moving.stop(250);
	}
	wheel(delta) {
		this.speed *= Math.exp(-.002 * delta);
	}
	key(event, down) {
		if (!this.isOn) return;
		if (event.code === "Escape") this.stop();
		else if (/^(Key[WASDQE]|Shift(Left|Right))$/.test(event.code)) down ? this.held.add(event.code) : this.held.delete(event.code);
		else return;
		event.preventDefault();
		event.stopPropagation();
	}
	step(time) {
		if (!this.isOn) return;
		const seconds = Math.min(Math.max((time - this.last) / 1e3, 0), .1);
		this.last = time;
		const along = (plus, minus) => Number(this.held.has(plus)) - Number(this.held.has(minus));
		const { camera } = this;
		const parts = [
			[camera.forward, along("KeyW", "KeyS")],
			[camera.right, along("KeyD", "KeyA")],
			[camera.axis, along("KeyE", "KeyQ")]
		];
		const fast = this.held.has("ShiftLeft") || this.held.has("ShiftRight") ? 4 : 1;
		if (parts.some(([, s]) => s !== 0)) {
			const by = parts.map(([v, s]) => scale(v, s * fast * this.speed * seconds)).reduce(add);
			camera.move(by);
			this.moving.moved();
			this.moving.stop(250);
		}
		requestAnimationFrame((next) => this.step(next));
	}
};
// src/inspector.ts
/** Panel "Pixel": the values under the pointer, and all that the server knows of a pixel that was clicked. */
/** Milliseconds between two questions about a pixel while it changes. */
var PAUSE = 1e3;
var Inspector = class {
	path;
	changed;
	element;
	/** The pixel that's pinned. */
	pinned = null;
	/** Called with what is known of the pinned pixel. */
	told = () => {};
	hover = h("p", { class: "values" }, "Point at the picture; click to pin a pixel and select.");
	pin = h("div", {
		class: "pin",
		"aria-live": "polite"
	});
	asked = 0;
	timer = 0;
	/** `path` shows the path of a sample of the pinned pixel. */
	constructor(path, changed) {
		this.path = path;
		this.changed = changed;
		this.element = section("Pixel", true, this.hover, path.element, this.pin);
	}
	/** Values under the pointer. */
	show(pixel, values, isMixed) {
		if (!pixel || !values) return setText(this.hover, "Point at the picture; click to pin a pixel and select.");
		setText(this.hover, `${pixel[0]}, ${pixel[1]}:  ${values.map(show).join("  ")}${isMixed ? "  (mixed)" : ""}`);
	}
	set(pixel) {
		this.pinned = pixel;
		this.pin.replaceChildren();
		this.changed();
		this.path.set(pixel);
		if (pixel) this.ask();
	}
	/** The picture has changed. */
	refresh() {
		if (!this.pinned || this.timer) return;
		this.timer = window.setTimeout(() => void this.ask(), Math.max(0, this.asked + PAUSE - performance.now()));
	}
	async ask() {
		clearTimeout(this.timer);
		this.timer = 0;
		this.asked = performance.now();
		const pixel = this.pinned;
		if (!pixel) return;
		try {
			const response = await fetch(`./api/pixel?x=${pixel[0]}&y=${pixel[1]}`);
			const body = await response.json();
			if (this.pinned !== pixel) return;
			if ("channels" in body) {
				this.fill(body);
				this.told(body);
			} else this.pin.replaceChildren(this.head(pixel), h("p", { class: "facts" }, body.error ?? response.statusText));
		} catch {
			if (this.pinned === pixel && this.pin.childElementCount === 0) this.pin.replaceChildren(this.head(pixel), h("p", { class: "facts" }, "no answer"));
		}
	}
	head([x, y]) {
		const unpin = h("button", {
			class: "small",
			title: "Unpin the pixel",
			"aria-label": "Unpin the pixel",
			onclick: () => this.set(null)
		}, "×");
		return h("div", { class: "pin-head" }, h("strong", {}, `Pixel ${x}, ${y}`), unpin);
	}
	fill(pixel) {
		const facts = [
			["samples", show(pixel.samples)],
			["error", pixel.error === null ? null : `${show(100 * pixel.error)} %`],
			["object", pixel.object],
			["material", pixel.material],
			["light", pixel.light]
		].filter((f) => f[1] !== null);
		const rows = /* @__PURE__ */ new Map();
		for (const [name, value] of Object.entries(pixel.channels)) {
			const dot = name.lastIndexOf(".");
			const layer = dot < 0 ? /^[RGB]$/.test(name) ? "picture" : name : name.slice(0, dot);
			rows.set(layer, [...rows.get(layer) ?? [], text(value)]);
		}
		const line = (name, values) => h("tr", {}, h("th", { scope: "row" }, name), h("td", {}, values.join("  ")));
		const table = h("table", {}, h("tbody", {}, ...[...rows].map(([n, v]) => line(n, v)), ...facts.map(([n, v]) => line(n, [v]))));
		this.pin.replaceChildren(this.head([pixel.x, pixel.y]), table);
	}
};
/** A float's shortest digits. */
function text(value) {
	if (typeof value !== "number") return value;
	const short = Number(value.toPrecision(7));
	return Math.abs(short) < 1e-4 && short !== 0 ? short.toExponential() : String(short);
}
// src/magma.ts
/** Errors as colours, as crates/image/src/metrics/difference.rs has them, and their scale. */
/** Nine evenly spaced colours of the map "magma" (S. van der Walt, N. Smith 2015, CC0), sRGB. */
var COLORS = [
	4,
	1839172,
	5182075,
	8463745,
	11875962,
	15030628,
	16484193,
	16695943,
	16580031
];
/** `magma(x)`: the colour of a number from 0 to 1. */
var MAGMA_GLSL = `
const vec3 magmaColors[9] = vec3[9](${COLORS.map((c) => `vec3(${bytes(c).map((v) => v.toFixed(1)).join(", ")})`).join(", ")});

vec3 magma(float x) {
  float t = clamp(x, 0.0, 1.0) * 8.0;
  int i = min(int(t), 7);
  return floor(mix(magmaColors[i], magmaColors[i + 1], t - float(i)) + 0.5) / 255.0;
}
`;
/** The scale of FLIP errors. */
var FLIP_SCALE = {
	label: "FLIP error from 0, the same, to 1",
	unit: "FLIP",
	colors: COLORS,
	ticks: [
		0,
		.2,
		.4,
		.6,
		.8,
		1
	].map((v) => [v, String(v)])
};
// src/moving.ts
/** Milliseconds after which a picture that didn't come is no longer waited for. */
var PATIENCE = 4e3;
var Moving = class {
	camera;
	send;
	isDirty = false;
	queued = 0;
	sentAt = null;
	sentGeneration = 0;
	generation = 0;
	stopTimer = 0;
	isMoving = false;
	nextFov = null;
	constructor(camera, send) {
		this.camera = camera;
		this.send = send;
	}
	/** The camera has been moved. */
	moved() {
		this.isMoving = true;
		this.isDirty = true;
		clearTimeout(this.stopTimer);
		this.schedule();
	}
	/** The movement has ended, now or when nothing moves for some milliseconds. */
	stop(after = 0) {
		clearTimeout(this.stopTimer);
		if (after > 0) this.stopTimer = window.setTimeout(() => this.stop(), after);
		else if (this.isMoving) {
			this.isMoving = this.isDirty = false;
			this.sentAt = null;
			this.post(false);
		}
	}
	/** The server is asked for another camera: this one's movement is over, and the next state counts. */
	release() {
		clearTimeout(this.stopTimer);
		this.isMoving = this.isDirty = false;
		this.sentAt = this.nextFov = null;
	}
	/** A picture came. */
	frame(generation) {
		this.generation = Math.max(this.generation, generation);
		if (this.sentAt !== null && generation > this.sentGeneration) {
			this.sentAt = null;
			if (this.isDirty) this.schedule();
		}
	}
	/** What holds now: takes its camera, unless this page is moving it. */
	state(generation, state, isNew) {
		if (isNew) this.generation = generation;
		const { camera } = this;
		const isOther = length(sub(state.eye, camera.eye)) + length(sub(state.target, camera.target)) > 1e-4 * camera.distance;
		if (isNew || !this.isMoving && (!state.moved || isOther)) camera.adopt(state);
	}
	/** Another angle of view, in degrees. */
	fov(degrees) {
		this.nextFov = degrees;
		this.moved();
		this.stop(250);
	}
	schedule() {
		this.queued ||= requestAnimationFrame(() => {
			this.queued = 0;
			if (this.sentAt !== null && performance.now() - this.sentAt < PATIENCE) window.setTimeout(() => this.isDirty && this.schedule(), PATIENCE);
			else if (this.isDirty) this.post(true);
		});
	}
	post(moving) {
		const { eye, target, up } = this.camera;
		if (moving) {
			this.isDirty = false;
			this.sentAt = performance.now();
			this.sentGeneration = this.generation;
		}
		this.send({
			type: "camera",
			eye,
			target,
			up,
			...this.nextFov === null ? {} : { fov: this.nextFov },
			moving
		});
		if (!moving) this.nextFov = null;
	}
};
// src/navigate.ts
/** CSS pixels that a click may move. */
var STILL$1 = 4;
var Navigate = class {
	view;
	camera;
	moving;
	fly;
	actions;
	drag = null;
	start = [0, 0];
	last = [0, 0];
	isClick = false;
	touches = /* @__PURE__ */ new Map();
	constructor(view, camera, moving, fly, actions) {
		this.view = view;
		this.camera = camera;
		this.moving = moving;
		this.fly = fly;
		this.actions = actions;
		const { canvas } = view;
		canvas.addEventListener("pointerdown", (event) => this.down(event));
		canvas.addEventListener("pointermove", (event) => this.move(event));
		canvas.addEventListener("pointerup", (event) => this.up(event));
		canvas.addEventListener("pointercancel", (event) => this.up(event));
		canvas.addEventListener("pointerleave", () => actions.hover(null));
		canvas.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
		canvas.addEventListener("contextmenu", (event) => event.preventDefault());
		canvas.addEventListener("mousedown", (event) => event.button === 1 && event.preventDefault());
	}
	down(event) {
		if (this.fly.on) return this.fly.stop();
		if (event.button > 1) return;
		this.view.canvas.focus({ preventScroll: true });
		this.view.canvas.setPointerCapture(event.pointerId);
		const at = [event.clientX, event.clientY];
		if (event.pointerType === "touch") this.touches.set(event.pointerId, at);
		this.isClick = event.button === 0 && this.touches.size < 2;
		this.start = this.last = at;
		if (this.actions.drawsRegion() && event.button === 0) this.drag = "region";
		else if (event.ctrlKey || event.metaKey || !this.actions.isMovable()) this.drag = "picture";
		else this.drag = event.shiftKey ? "pan" : "orbit";
	}
	move(event) {
		const at = [event.clientX, event.clientY];
		if (this.fly.on) return this.fly.look(event.movementX, event.movementY);
		if (event.pointerType !== "touch") this.actions.hover(this.view.pixelAt(...at));
		if (!this.drag) return;
		if (Math.hypot(at[0] - this.start[0], at[1] - this.start[1]) > STILL$1) this.isClick = false;
		if (this.touches.size === 2) return this.pinch(event.pointerId, at);
		if (this.touches.has(event.pointerId)) this.touches.set(event.pointerId, at);
		if (this.isClick) return;
		const [dx, dy] = [at[0] - this.last[0], at[1] - this.last[1]];
		this.last = at;
		if (this.drag === "region") return this.actions.region(this.view.pixelAt(...this.start), this.view.pixelAt(...at), false);
		if (this.drag === "picture") {
			this.view.placement.pan(Math.round(dx * devicePixelRatio), Math.round(dy * devicePixelRatio));
			return this.view.redraw();
		}
		if (this.drag === "orbit") this.camera.orbit(dx, dy);
		else this.camera.pan(dx, dy, this.pictureSize());
		this.moving.moved();
	}
	up(event) {
		const wasPinch = this.touches.size > 1;
		this.touches.delete(event.pointerId);
		if (wasPinch) {
			for (const at of this.touches.values()) this.last = this.start = at;
			return;
		}
		const { drag } = this;
		this.drag = null;
		if (!drag) return;
		const at = [event.clientX, event.clientY];
		if (event.type === "pointercancel") this.moving.stop();
		else if (drag === "region") this.actions.region(this.view.pixelAt(...this.start), this.view.pixelAt(...at), true);
		else if (this.isClick) this.actions.click(this.view.pixelAt(...at));
		else this.moving.stop();
	}
	/** Two fingers: their middle pans, their distance dollies. */
	pinch(id, at) {
		const other = [...this.touches].find(([key]) => key !== id)?.[1];
		const before = this.touches.get(id);
		this.touches.set(id, at);
		if (!other || !before) return;
		const apart = (a) => Math.max(Math.hypot(a[0] - other[0], a[1] - other[1]), 1);
		const [dx, dy] = [(at[0] - before[0]) / 2, (at[1] - before[1]) / 2];
		if (this.actions.isMovable()) {
			this.camera.pan(dx, dy, this.pictureSize());
			this.camera.dolly(apart(before) / apart(at));
			this.moving.moved();
		} else {
			this.view.placement.pan(dx * devicePixelRatio, dy * devicePixelRatio);
			const middle = this.view.devicePixel((at[0] + other[0]) / 2, (at[1] + other[1]) / 2);
			this.view.placement.zoom(apart(at) / apart(before), ...middle);
			this.view.redraw();
		}
	}
	wheel(event) {
		event.preventDefault();
		const delta = event.deltaY * (event.deltaMode === 1 ? 16 : event.deltaMode === 2 ? 400 : 1);
		if (this.fly.on) return this.fly.wheel(delta);
		if (event.ctrlKey || event.metaKey || !this.actions.isMovable()) {
			const factor = Math.exp(-Math.max(-100, Math.min(100, delta)) * .003);
			this.view.placement.zoom(factor, ...this.view.devicePixel(event.clientX, event.clientY));
			return this.view.redraw();
		}
		this.camera.dolly(Math.exp(delta * .001));
		this.moving.moved();
		this.moving.stop(250);
	}
	/** The picture's smaller side, CSS pixels. */
	pictureSize() {
		const { film, placement } = this.view;
		return Math.min(film.width, film.height) * placement.scale / devicePixelRatio;
	}
};
/** Lengths in CSS pixels: of arrows, and of a vertex' radius. */
var ARROW = 46;
var RADIUS = 8;
var SVG = "http://www.w3.org/2000/svg";
/** An element of SVG. */
function svg(tag, attributes) {
	const element = document.createElementNS(SVG, tag);
	for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
	return element;
}
/** Whether light arrives. */
var isLit = (light) => light.some((v) => v !== 0);
var Drawing = class {
	view;
	element = svg("svg", { class: "path" });
	path = null;
	isWrapped = false;
	marked = -1;
	constructor(view) {
		this.view = view;
	}
	/** `isWrapped`: the picture's left and right edge are neighbours. */
	show(path, isWrapped = false) {
		[this.path, this.isWrapped, this.marked] = [
			path,
			isWrapped,
			-1
		];
		this.place();
	}
	/** Stresses a vertex, or none. */
	mark(index) {
		this.marked = index;
		this.place();
	}
	/** Puts all where the picture is. */
	place() {
		this.element.replaceChildren(...this.path ? this.draw(this.path.vertices) : []);
	}
	draw(vertices) {
		const [lights, rays, dots] = [
			[],
			[],
			[]
		];
		for (const [index, vertex] of vertices.entries()) {
			if (!vertex.place) continue;
			const from = this.at(vertex.place);
			const { direct, event } = vertex;
			const next = vertices[index + 1];
			if (direct) {
				const way = isLit(direct.light) ? "light" : "light blocked";
				if (direct.place) lights.push(...this.line(way, from, this.at(direct.place)));
				else if (direct.onwards) lights.push(...this.arrow(way, from, direct.onwards));
			}
			if (next?.place && !this.wraps(vertex.place, next.place)) rays.push(...this.line("ray", from, this.at(next.place)));
			else if (next && vertex.onwards) rays.push(...this.arrow(next.kind === "escaped" ? "ray escaping" : "ray", from, vertex.onwards));
			if (index <= 100) dots.push(this.dot(index, from, next === void 0 || event === null));
		}
		return [
			...lights,
			...rays,
			...dots
		];
	}
	wraps([x], [u]) {
		return this.isWrapped && Math.abs(x - u) > this.view.film.width / 2;
	}
	/** CSS pixels of a place in the picture. */
	at([x, y]) {
		const { left, top, scale } = this.view.placement;
		const css = (v, start) => Math.min(Math.max((start + v * scale) / devicePixelRatio, -1e5), 1e5);
		return [css(x, left), css(y, top)];
	}
	/** A line with a dark edge, so that it is seen on anything. */
	line(way, [x1, y1], [x2, y2]) {
		return ["edge", way].map((name) => svg("line", {
			class: name === "edge" ? `edge ${way}` : way,
			x1,
			y1,
			x2,
			y2
		}));
	}
	arrow(way, [x, y], [dx, dy]) {
		const [ex, ey] = [x + ARROW * dx, y + ARROW * dy];
		const corner = (turn) => `${ex - 9 * dx + turn * dy},${ey - 9 * dy - turn * dx}`;
		const points = `${ex + dx},${ey + dy} ${corner(5)} ${corner(-5)}`;
		return [...this.line(way, [x, y], [ex - 6 * dx, ey - 6 * dy]), svg("polygon", {
			class: `head ${way}`,
			points
		})];
	}
	dot(index, [cx, cy], isLast) {
		const group = svg("g", { class: `vertex${isLast ? " last" : ""}${index === this.marked ? " marked" : ""}` });
		const text = svg("text", {
			x: cx,
			y: cy
		});
		text.textContent = String(index);
		group.append(svg("circle", {
			cx,
			cy,
			r: index > 9 ? 10 : RADIUS
		}), text);
		return group;
	}
};
// src/gizmo.ts
/** Arrows at the selected shape, by which it is dragged along the axes of the world. */
var AXES = [
	"x",
	"y",
	"z"
];
/** Length of an arrow in CSS pixels. */
var LENGTH = 64;
/** Axes that are shorter in the picture than this part of the longest have no arrow: they point at the camera. */
var SHORTEST = .15;
/** CSS pixels that a click may move. */
var STILL = 4;
var Gizmo = class {
	view;
	element = svg("svg", { class: "gizmo" });
	/** Called as the shape is dragged along an axis, with the distance from where it was. */
	moved = () => {};
	/** Called on a click, which is about what lies beneath. */
	clicked = () => {};
	handle = null;
	next = null;
	drag = null;
	constructor(view) {
		this.view = view;
		this.element.addEventListener("pointerdown", (event) => this.down(event));
		this.element.addEventListener("pointermove", (event) => this.move(event, false));
		for (const type of ["pointerup", "pointercancel"]) this.element.addEventListener(type, (event) => this.move(event, true));
	}
	/** What is dragged keeps its arrows until it is let go. */
	show(handle) {
		this.next = handle;
		if (!this.drag) this.handle = handle;
		this.place();
	}
	place() {
		const { handle, drag } = this;
		if (!handle) return this.element.replaceChildren();
		const { left, top, scale } = this.view.placement;
		const from = handle.at.map((v, i) => {
			const along = drag ? handle.axes[drag.axis][i] * drag.distance : 0;
			return ([left, top][i] + (v + along) * scale) / devicePixelRatio;
		});
		const sizes = handle.axes.map(([x, y]) => Math.hypot(x, y));
		const isLong = (axis) => sizes[axis] > SHORTEST * Math.max(...sizes);
		this.element.replaceChildren(...[
			0,
			1,
			2
		].filter(isLong).map((axis) => this.arrow(axis, from, handle.axes[axis], sizes[axis])));
	}
	arrow(axis, [x, y], [ax, ay], size) {
		const [dx, dy] = [ax / size, ay / size];
		const [x2, y2] = [x + LENGTH * dx, y + LENGTH * dy];
		const corner = (turn) => `${x2 - 11 * dx + turn * dy},${y2 - 11 * dy - turn * dx}`;
		const lines = [
			"edge",
			"line",
			"hit"
		].map((name) => svg("line", {
			class: name,
			x1: x,
			y1: y,
			x2,
			y2
		}));
		const group = svg("g", {
			class: `arrow ${AXES[axis]}`,
			"data-axis": axis
		});
		group.append(lines[0], lines[1], svg("polygon", { points: `${x2 + 3 * dx},${y2 + 3 * dy} ${corner(6)} ${corner(-6)}` }), lines[2]);
		return group;
	}
	down(event) {
		const axis = event.target.closest(".arrow")?.dataset.axis;
		if (event.button !== 0 || axis === void 0) return;
		event.preventDefault();
		this.element.setPointerCapture(event.pointerId);
		this.drag = {
			axis: Number(axis),
			start: [event.clientX, event.clientY],
			distance: 0,
			hasMoved: false
		};
	}
	move(event, done) {
		const { drag, handle } = this;
		if (!drag || !handle) return;
		const [ax, ay] = handle.axes[drag.axis];
		const factor = devicePixelRatio / this.view.placement.scale;
		const [dx, dy] = [(event.clientX - drag.start[0]) * factor, (event.clientY - drag.start[1]) * factor];
		drag.distance = Number(((dx * ax + dy * ay) / (ax * ax + ay * ay)).toPrecision(6));
		drag.hasMoved ||= Math.hypot(event.clientX - drag.start[0], event.clientY - drag.start[1]) > STILL;
		if (drag.hasMoved) this.moved(drag.axis, drag.distance, done);
		else if (event.type === "pointerup") this.clicked(event.clientX, event.clientY);
		else drag.distance = 0;
		if (done) {
			this.drag = null;
			this.handle = this.next;
		}
		this.place();
	}
};
// src/outline.ts
/** The outline of the selected shape over the picture, along the edges of its pixels. */
/** The edges between pixels of the shape and others, as a path of SVG; a pixel is one long. */
function edges(runs) {
	const rows = /* @__PURE__ */ new Map();
	for (const [row, from, to] of runs) rows.set(row, [
		...rows.get(row) ?? [],
		from,
		to
	]);
	const upright = runs.flatMap(([row, from, to]) => [`M${from} ${row}v1`, `M${to} ${row}v1`]);
	const level = [...new Set([...rows.keys()].flatMap((row) => [row, row + 1]))].flatMap((row) => {
		const ends = [...rows.get(row - 1) ?? [], ...rows.get(row) ?? []].sort((a, b) => a - b);
		return ends.flatMap((end, i) => i % 2 === 0 && ends[i + 1] > end ? `M${end} ${row}H${ends[i + 1]}` : []);
	});
	return [...upright, ...level].join("");
}
var OutlineDrawing = class {
	view;
	element = svg("svg", { class: "outline" });
	group = svg("g", {});
	outline = null;
	constructor(view) {
		this.view = view;
		this.element.append(this.group);
	}
	show(outline) {
		this.outline = outline;
		const d = outline ? edges(outline.runs) : "";
		this.group.replaceChildren(...d ? ["edge", "line"].map((name) => svg("path", {
			class: name,
			d
		})) : []);
		this.place();
	}
	/** Puts it where the picture is. */
	place() {
		if (!this.outline) return;
		const { left, top, scale } = this.view.placement;
		const { origin, pixel } = this.outline;
		const at = (start, from) => (start + from * scale) / devicePixelRatio;
		const sizes = pixel.map((size) => size * scale / devicePixelRatio);
		this.group.setAttribute("transform", `matrix(${sizes[0]} 0 0 ${sizes[1]} ${at(left, origin[0])} ${at(top, origin[1])})`);
	}
};
// src/overlay.ts
/** What lies over the picture: the region's frame, the pinned pixel's mark, the selected shape's outline and arrows, and a path. */
var Overlay = class {
	view;
	element = h("div", {
		class: "overlay",
		"aria-hidden": "true"
	});
	/** The region that's rendered, or that is being drawn. */
	region = null;
	pin = null;
	drawing;
	outline;
	gizmo;
	frame = h("div", { class: "region" });
	mark = h("div", { class: "mark" });
	constructor(view) {
		this.view = view;
		this.drawing = new Drawing(view);
		this.outline = new OutlineDrawing(view);
		this.gizmo = new Gizmo(view);
		this.element.append(this.outline.element, this.frame, this.mark, this.drawing.element, this.gizmo.element);
	}
	/** Puts all where the picture is. */
	place() {
		this.put(this.frame, this.region);
		this.put(this.mark, this.pin && [
			this.pin[0],
			this.pin[1],
			this.pin[0] + 1,
			this.pin[1] + 1
		]);
		this.outline.place();
		this.drawing.place();
		this.gizmo.place();
	}
	put(element, box) {
		element.hidden = box === null;
		if (!box) return;
		const { left, top, scale } = this.view.placement;
		const at = (v, start) => (start + v * scale) / devicePixelRatio;
		const [x, y] = [at(box[0], left), at(box[1], top)];
		Object.assign(element.style, {
			left: `${x}px`,
			top: `${y}px`,
			width: `${at(box[2], left) - x}px`,
			height: `${at(box[3], top) - y}px`
		});
	}
};
/** The region between two corners in any order, both included, within the film; `null` where nothing is left. */
function regionOf([ax, ay], [bx, by], film) {
	const clamp = (v, high) => Math.min(Math.max(v, 0), high);
	const [x0, x1] = [clamp(Math.min(ax, bx), film.width), clamp(Math.max(ax, bx) + 1, film.width)];
	const [y0, y1] = [clamp(Math.min(ay, by), film.height), clamp(Math.max(ay, by) + 1, film.height)];
	return x1 - x0 >= 2 && y1 - y0 >= 2 ? [
		x0,
		y0,
		x1,
		y1
	] : null;
}
// src/path.ts
/** The path of one sample of the pinned pixel: what is asked for, and the table of its vertices. */
var ENDS = {
	escaped: "leaves the scene",
	absorbed: "absorbed",
	depth: "greatest depth",
	roulette: "Russian roulette",
	"not finite": "not finite",
	"too long": "too many vertices: the rest is left out"
};
var Path = class {
	drawing;
	pin;
	element;
	button;
	number = h("input", {
		class: "number",
		type: "number",
		min: 0,
		max: 16777215,
		value: 0,
		"aria-label": "Sample"
	});
	group;
	facts = h("p", {
		class: "facts",
		"aria-live": "polite"
	});
	table = h("div");
	pixel = null;
	sample = 0;
	state = null;
	on = false;
	/** `pin` pins a pixel where none is. */
	constructor(drawing, pin) {
		this.drawing = drawing;
		this.pin = pin;
		this.button = h("button", {
			"aria-pressed": "false",
			title: "Draw the path of one sample of the pinned pixel (T)"
		}, "Path");
		this.button.addEventListener("click", () => this.toggle());
		const step = (by, text, name) => h("button", {
			class: "small",
			title: name,
			"aria-label": name,
			onclick: () => this.go(this.sample + by)
		}, text);
		this.number.addEventListener("change", () => this.go(this.number.valueAsNumber));
		this.group = h("div", {
			class: "samples",
			role: "group",
			"aria-label": "Sample of the pixel",
			hidden: true
		}, h("span", { "aria-hidden": "true" }, "Sample"), step(-1, "‹", "Previous sample"), this.number, step(1, "›", "Next sample"));
		const bar = h("div", { class: "path-bar" }, this.button, this.group);
		bar.addEventListener("keydown", (event) => this.press(event));
		this.element = h("div", { class: "traced" }, bar, this.facts, this.table);
	}
	/** Whether clicks trace paths. */
	get isOn() {
		return this.on;
	}
	toggle() {
		this.on = !this.on;
		setPressed(this.button, this.on);
		this.group.hidden = !this.on;
		if (!this.on) return this.clear("");
		if (this.pixel) this.ask();
		else this.pin();
	}
	/** The pinned pixel is another. */
	set(pixel) {
		this.pixel = pixel;
		if (this.on && pixel) this.ask();
		else if (this.on) this.clear("Click the picture to trace a pixel.");
	}
	/** What is rendered may be another. */
	update(state) {
		const before = this.state;
		this.state = state;
		if (!this.on || !before || before.generation === state.generation) return;
		const seen = ({ camera: { eye, target, up, fov, name }, film }) => JSON.stringify([
			eye,
			target,
			up,
			fov,
			name,
			film
		]);
		if (seen(before) !== seen(state)) this.clear("The camera has moved: click the picture to trace a pixel.");
		else if (this.table.childElementCount) this.ask();
	}
	clear(why) {
		this.drawing.show(null);
		this.table.replaceChildren();
		setText(this.facts, why);
	}
	press(event) {
		const by = {
			ArrowLeft: -1,
			ArrowRight: 1,
			ArrowUp: 1,
			ArrowDown: -1
		}[event.key];
		if (!this.on || by === void 0) return;
		event.preventDefault();
		this.go(this.sample + by);
	}
	go(sample) {
		this.sample = Number.isFinite(sample) ? Math.min(Math.max(Math.round(sample), 0), 16777215) : this.sample;
		this.number.value = String(this.sample);
		if (this.pixel) this.ask();
	}
	async ask() {
		const { pixel, sample } = this;
		if (!pixel) return;
		const isAsked = () => this.on && this.pixel === pixel && this.sample === sample;
		try {
			const response = await fetch(`./api/path?x=${pixel[0]}&y=${pixel[1]}&sample=${sample}`);
			const body = await response.json();
			if (!isAsked()) return;
			if (!("vertices" in body)) this.clear(body.error ?? response.statusText);
			else if (!this.state || body.generation >= this.state.generation) this.fill(body);
		} catch {
			if (isAsked()) this.clear("no answer");
		}
	}
	fill(path) {
		this.drawing.show(path, this.state?.camera.kind.startsWith("spherical"));
		const last = path.vertices.length - 1;
		const whose = path.of_picture ? "" : ` The picture’s method has no such paths: this is one of the path tracer (${path.tracer}).`;
		setText(this.facts, `Pixel ${path.x}, ${path.y}: light ${triple(path.value)}; ${last} ${last === 1 ? "vertex" : "vertices"}, ends: ${ENDS[path.end]}.${whose}`);
		const head = [
			"#",
			"Vertex",
			"Weight",
			"Light"
		].map((name) => h("th", { scope: "col" }, name));
		const rows = path.vertices.slice(0, 101).map((v, k) => this.row(v, k));
		const more = last - 100;
		this.table.replaceChildren(h("table", { class: "vertices" }, h("caption", { class: "hidden" }, "Vertices of the path"), h("thead", {}, h("tr", {}, ...head)), h("tbody", {}, ...rows)), ...more > 0 ? [h("p", { class: "facts" }, `and ${more} more`)] : []);
	}
	row(v, index) {
		const light = v.emitted.map((e, c) => e + (v.direct?.light[c] ?? 0));
		const sampled = v.direct && (isLit(v.direct.light) ? "light sample" : "light sample blocked");
		const lines = [
			v.object,
			v.material,
			v.event,
			isLit(v.emitted) ? "emits" : null,
			sampled
		].filter((line) => line !== null);
		const row = h("tr", { title: `at ${triple(v.position)}` }, h("th", { scope: "row" }, String(index)), h("td", {}, v.kind, ...lines.map((line) => h("span", {}, line))), values(v.weight), isLit(light) || v.direct ? values(light) : h("td", { class: "rgb" }, "–"));
		row.addEventListener("pointerenter", () => this.drawing.mark(index));
		row.addEventListener("pointerleave", () => this.drawing.mark(-1));
		return row;
	}
};
/** Red, green and blue below each other; one number where they are the same. */
function values(rgb) {
	return h("td", { class: "rgb" }, ...(rgb[0] === rgb[1] && rgb[1] === rgb[2] ? [rgb[0]] : rgb).map((v) => h("span", {}, number(v))));
}
/** JSON has no number that is not finite. */
var number = (v) => v === null ? "NaN" : show(Number(v.toPrecision(3)));
var triple = (rgb) => rgb.map(number).join("  ");
// src/pick.ts
var Pick = class {
	camera;
	move;
	send;
	tell;
	/** The pixel under the pointer. */
	pixel = null;
	constructor(camera, move, send, tell) {
		this.camera = camera;
		this.move = move;
		this.send = send;
		this.tell = tell;
	}
	/** Turns the camera to the point, about which it turns from then on. */
	async center() {
		const point = await this.point();
		if (point) this.move(() => this.camera.center(point));
	}
	/** Makes sharp what is as far along the axis as the point. */
	async focus({ id, unit, lens }) {
		if (lens === null) return this.tell({
			severity: "note",
			text: "this kind of camera has no focal distance"
		});
		const point = await this.point();
		if (!point) return;
		const far = dot(sub(point, this.camera.eye), this.camera.forward) / unit;
		if (!(far > 0)) return this.tell({
			severity: "note",
			text: "the point is not in front of the camera"
		});
		this.send({
			type: "edit",
			node: id,
			parameter: "focal_distance",
			value: String(Number(far.toPrecision(7))),
			moving: false
		});
		if (lens <= 0) this.tell({
			severity: "note",
			text: `all is sharp through a pinhole: 'lens_radius' of ${id} above 0 shows where the focus is`
		});
	}
	async point() {
		const none = (text) => (this.tell({
			severity: "note",
			text
		}), null);
		if (!this.pixel) return none("there is no point under the pointer");
		const [x, y] = this.pixel;
		try {
			const pixel = await (await fetch(`./api/pixel?x=${x}&y=${y}`)).json();
			if (!("channels" in pixel)) return none(pixel.error);
			const { "P.X": px, "P.Y": py, "P.Z": pz, Z: depth } = pixel.channels;
			if (px === void 0) return none("points are not known of a preview: try again in a moment");
			return [
				px,
				py,
				pz,
				depth
			].every((v) => typeof v === "number") ? [
				px,
				py,
				pz
			] : none("there is no surface under the pointer");
		} catch {
			return none("no answer");
		}
	}
};
// src/selection.ts
var Selection = class {
	drawing;
	gizmo;
	selected = null;
	/** Called when something else is selected. */
	changed = () => {};
	/** Whether the pixel that is asked about selects. */
	waits = false;
	scene = "";
	generation = 0;
	frameKey = "";
	outlined = "";
	constructor(drawing, gizmo) {
		this.drawing = drawing;
		this.gizmo = gizmo;
	}
	/** A pixel was clicked: what is known of it selects. */
	click() {
		this.waits = true;
	}
	/** What is known of the clicked pixel; coarse pictures may know no surfaces. */
	take({ hasSurface, object, material, light }) {
		if (!this.waits || !hasSurface) return;
		this.set(object === null ? null : {
			shape: object,
			material,
			light
		});
	}
	set(selected) {
		this.waits = false;
		if (selected === null && this.selected === null) return;
		const isOther = selected?.shape !== this.selected?.shape;
		this.selected = selected;
		if (isOther) {
			this.outlined = "";
			this.show(null);
			this.outline();
		}
		this.changed(selected);
	}
	/** Of another picture the outline is another. */
	state({ generation, scene }) {
		const name = `${scene.path} ${scene.name}`;
		if (name !== this.scene) this.set(null);
		this.scene = name;
		if (generation === this.generation) return;
		this.generation = generation;
		this.outlined = "";
		this.show(null);
	}
	show(outline) {
		this.drawing.show(outline);
		this.gizmo.show(outline?.handle ?? null);
	}
	frame({ generation, width, height, kind }) {
		this.frameKey = `${generation} ${width} ${height} ${kind}`;
		this.outline();
	}
	async outline() {
		const { selected, frameKey } = this;
		if (!selected || this.outlined === frameKey) return;
		this.outlined = frameKey;
		try {
			const response = await fetch(`./api/outline?shape=${encodeURIComponent(selected.shape)}`);
			const outline = response.ok ? await response.json() : null;
			if (selected.shape !== this.selected?.shape || this.outlined !== frameKey) return;
			if (outline?.generation === this.generation) this.show(outline);
			else this.outlined = "";
		} catch {
			this.outlined = "";
		}
	}
};
// src/theme.ts
/** Dark or light: as the system has it, or as chosen. */
var THEMES = [
	"auto",
	"dark",
	"light"
];
var KEY = "steradian-theme";
function themeButton(changed) {
	let theme = THEMES.find((t) => t === stored()) ?? "auto";
	const light = matchMedia("(prefers-color-scheme: light)");
	const button = h("button", { onclick: () => set(THEMES[(THEMES.indexOf(theme) + 1) % THEMES.length]) });
	function set(to) {
		theme = to;
		store(to);
		apply();
		button.textContent = {
			auto: "◐",
			dark: "●",
			light: "○"
		}[to];
		button.title = `Theme: ${to}`;
		button.setAttribute("aria-label", button.title);
	}
	function apply() {
		document.documentElement.dataset.theme = theme === "auto" ? light.matches ? "light" : "dark" : theme;
		changed();
	}
	set(theme);
	light.addEventListener("change", apply);
	return button;
}
/** Storage that the browser may refuse. */
function stored() {
	try {
		return localStorage.getItem(KEY);
	} catch {
		return null;
	}
}
function store(theme) {
	try {
		localStorage.setItem(KEY, theme);
	} catch {}
}
// src/toolbar.ts
/** Buttons over the picture. */
function toggleFullScreen() {
	(document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen()).catch(() => {});
}
var Toolbar = class {
	element;
	/** Whether the region tool is in hand. */
	region = false;
	regionButton;
	clearButton;
	pauseButton;
	panelButton;
	constructor(actions) {
		const button = (text, title, act, attributes = {}) => h("button", {
			title,
			onclick: act,
			...attributes
		}, text);
		this.regionButton = button("Region", "Render only what you frame (R)", () => this.setRegion(!this.region), { "aria-pressed": "false" });
		this.clearButton = button("Whole", "Render the whole picture again", actions.clearRegion);
		this.clearButton.hidden = true;
		this.pauseButton = button("Pause", "Pause or go on (P)", () => actions.pause(!isPressed(this.pauseButton)), { "aria-pressed": "false" });
		this.panelButton = button("Panel", "Show or hide the panel (N)", actions.panel, { "aria-expanded": "true" });
		this.element = h("div", {
			class: "toolbar",
			role: "toolbar",
			"aria-label": "Picture"
		}, button("Fit", "Fit the picture into the window (F)", actions.fit), button("1:1", "One pixel for each pixel (1)", actions.actual), this.regionButton, this.clearButton, this.pauseButton, h("span", { class: "gap" }), button("Full", "Full screen (F11)", toggleFullScreen, { "aria-label": "Full screen" }), themeButton(actions.themed), button("?", "Keys and pointer (?)", actions.help, { "aria-label": "Keys and pointer" }), this.panelButton);
	}
	update(state) {
		this.clearButton.hidden = state.region === null;
		this.setPaused(state.paused);
	}
	setPaused(on) {
		setPressed(this.pauseButton, on);
	}
	setRegion(on) {
		this.region = on;
		setPressed(this.regionButton, on);
		document.body.classList.toggle("draws-region", on);
	}
	setPanel(hidden) {
		this.panelButton.setAttribute("aria-expanded", String(!hidden));
	}
	/** As the button does. */
	press(which) {
		(which === "pause" ? this.pauseButton : this.panelButton).click();
	}
};
// src/placement.ts
/** Where the picture lies on the canvas: fitted, or zoomed and moved. Lengths are in device pixels. */
var LEAST = 1 / 16;
var MOST = 64;
var Placement = class {
	/** Device pixels for each pixel of the film. */
	scale = 1;
	/** The picture's left upper corner on the canvas. */
	left = 0;
	top = 0;
	fitted = true;
	canvas = {
		width: 1,
		height: 1
	};
	film = {
		width: 1,
		height: 1
	};
	/** Sizes may have changed. */
	update(canvas, film) {
		const same = canvas.width === this.canvas.width && canvas.height === this.canvas.height;
		const sameFilm = film.width === this.film.width && film.height === this.film.height;
		if (same && sameFilm) return;
		const [dx, dy] = [canvas.width - this.canvas.width, canvas.height - this.canvas.height];
		this.canvas = {
			width: canvas.width,
			height: canvas.height
		};
		this.film = {
			width: film.width,
			height: film.height
		};
		if (this.fitted) this.fit();
		else if (!sameFilm) this.center();
		else this.pan(dx / 2, dy / 2);
	}
	/** As large as the canvas allows, in its middle. */
	fit() {
		this.fitted = true;
		this.scale = Math.min(this.canvas.width / this.film.width, this.canvas.height / this.film.height);
		this.center();
	}
	/** One device pixel for each pixel of the film, in the middle. */
	actual() {
		this.fitted = false;
		this.scale = 1;
		this.center();
	}
	pan(dx, dy) {
		this.left += dx;
		this.top += dy;
		if (dx !== 0 || dy !== 0) this.fitted = false;
	}
	/** Magnifies; what is at (x, y) of the canvas stays there. */
	zoom(factor, x = this.canvas.width / 2, y = this.canvas.height / 2) {
		this.fitted = false;
		const before = this.scale;
		let scale = Math.min(Math.max(before * factor, LEAST), MOST);
		const near = scale >= 1 ? Math.round(scale) : 1 / Math.round(1 / scale);
		if (Math.abs(scale / near - 1) < .04 && Math.abs(near / before - 1) > .01) scale = near;
		this.scale = scale;
		this.left = Math.round(x - (x - this.left) * scale / before);
		this.top = Math.round(y - (y - this.top) * scale / before);
	}
	/** The film's pixel (with fraction) at a place of the canvas. */
	pixelAt(x, y) {
		return [(x - this.left) / this.scale, (y - this.top) / this.scale];
	}
	center() {
		this.left = Math.round((this.canvas.width - this.film.width * this.scale) / 2);
		this.top = Math.round((this.canvas.height - this.film.height * this.scale) / 2);
	}
};
// src/shader.ts
/** The shaders that draw the picture. */
var VERTEX = `#version 300 es
void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }`;
var FRAGMENT = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
uniform sampler2D picture;
uniform vec2 canvasSize, corner, shownSize;  // in device pixels; the picture's left upper corner, and its size there
uniform bool isGrey, isNearest, isFalse, isMarked;
uniform float gain;                          // 2 to the exposure
uniform sampler2D other;                     // the other picture, or a map of errors
uniform vec2 otherCorner, otherSize;
uniform int comparison;                      // 1 split, 2 the other one, 3 difference, 4 map
uniform float split;                         // in device pixels
uniform float differenceGain;
out vec4 color;
${TONE_GLSL}
${FALSE_COLOR_GLSL}
${MAGMA_GLSL}
${MIX_GLSL}
bool isFinite(float v) { return (floatBitsToUint(v) & 0x7f800000u) != 0x7f800000u; }
float sanitized(float v) { return v > 0.0 ? min(v, 1e9) : 0.0; }

bool isOutside(vec2 at) { return any(lessThan(at, vec2(0.0))) || any(greaterThanEqual(at, vec2(1.0))); }
bool isFinite(vec3 v) { return isFinite(v.r) && isFinite(v.g) && isFinite(v.b); }
vec3 colorAt(sampler2D from, vec2 at) {
  ivec2 size = textureSize(from, 0);
  return isNearest ? texelFetch(from, min(ivec2(at * vec2(size)), size - 1), 0).rgb : texture(from, at).rgb;
}

void main() {
  vec2 place = vec2(gl_FragCoord.x, canvasSize.y - gl_FragCoord.y);
  vec2 at = (place - corner) / shownSize;
  vec2 atOther = (place - otherCorner) / otherSize;
  bool isOther = comparison == 2 || comparison == 1 && place.x >= split;
  if (isOutside(at) || (isOther || comparison > 2) && isOutside(atOther)) {
    color = vec4(0.0);
    return;
  }
  vec3 v = groupCount > 0 ? mixedAt(at) : colorAt(picture, at);
  vec3 o = comparison > 0 ? colorAt(other, atOther) : v;
  if (comparison == 3) {
    vec3 d = v - o;
    bool isOdd = !isFinite(d);
    color = isOdd ? vec4(1.0, isMarked ? 0.0 : 1.0, 1.0, 1.0) : vec4(clamp(0.5 + 0.5 * gain * differenceGain * d, 0.0, 1.0), 1.0);
    return;
  }
  if (comparison == 4) {
    color = vec4(isFinite(o.r) ? magma(o.r) : vec3(1.0, 0.0, 1.0), 1.0);
    return;
  }
  if (isOther) v = o;
  if (isGrey) v = v.rrr;
  bool isOdd = !isFinite(v);
  if (isOdd && (isMarked || isFalse)) {
    color = vec4(1.0, 0.0, 1.0, 1.0);
    return;
  }
  if (isFalse) color = vec4(falseColor(luminance(v)), 1.0);
  else {
    vec3 exposed = v * gain;
    vec3 shown = toneCurve(vec3(sanitized(exposed.r), sanitized(exposed.g), sanitized(exposed.b)));
    color = vec4(floor(shown * 255.0 + 0.5) / 255.0, 1.0);
  }
}`;
/** The program of both. */
function link(gl) {
	const program = gl.createProgram();
	for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
		const shader = gl.createShader(kind);
		gl.shaderSource(shader, text);
		gl.compileShader(shader);
		if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader) ?? "no shader");
		gl.attachShader(program, shader);
	}
	gl.linkProgram(program);
	if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program) ?? "no program");
	return program;
}
// src/view.ts
/** The canvas: draws the shown layer through exposure and tone curve, or in false colour, alone or with another picture. */
var View = class {
	canvas;
	placement = new Placement();
	layers;
	/** `reference`, the picture's other one, and `map`, of how far they are apart. */
	others;
	/** The light of each group of lights, where the server sends it. */
	groups;
	comparison = "off";
	/** Where the picture ends and the other one begins, as a part of the canvas' width. */
	split = .5;
	/** Whether it's the other one's turn. */
	showsOther = false;
	differenceGain = 1;
	tone = {
		name: "none",
		values: [],
		exposure: 0
	};
	layer = "picture";
	isFalse = false;
	isMarked = true;
	film = {
		width: 1,
		height: 1
	};
	/** The part of the film that's rendered. */
	region = null;
	/** Called after each drawing. */
	drawn = () => {};
	gl;
	program;
	uniforms = /* @__PURE__ */ new Map();
	known = null;
	version = 0;
	queued = 0;
	constructor(canvas) {
		this.canvas = canvas;
		const gl = canvas.getContext("webgl2", {
			antialias: false,
			depth: false,
			powerPreference: "low-power"
		});
		if (!gl) throw new Error("this browser has no WebGL 2, which the picture is drawn with");
		gl.getExtension("OES_texture_half_float_linear");
		this.gl = gl;
		this.layers = new Layers(gl);
		this.others = new Layers(gl);
		this.groups = new Groups(gl);
		this.program = link(gl);
		new ResizeObserver(() => this.redraw()).observe(canvas);
		addEventListener("resize", () => this.redraw());
	}
	/** The frame that's shown: the layer's, or until it comes the picture's. */
	get picture() {
		return this.layers.shown(this.layer) ?? this.layers.shown("picture");
	}
	tile(layer, tile) {
		this.layers.tile(layer, tile);
	}
	/** A frame's tiles are all there. */
	frame(message) {
		this.layers.swap(message.crop);
		this.groups.swap(message.lightGroups, message.width, message.height);
		this.version++;
		this.redraw();
	}
	/** Whether a mix of groups of lights is shown. */
	get isMixed() {
		return this.layer === "picture" && this.groups.names.length > 0;
	}
	/** Mixes groups of lights by these factors of red, green and blue. */
	mix(weights) {
		this.groups.weights = weights;
		this.version++;
		this.redraw();
	}
	/** What the shown frame's pixels are like; counted once for each frame. */
	statistics() {
		const picture = this.picture;
		if (!picture) return null;
		if (this.known?.picture !== picture || this.known.version !== this.version) this.known = {
			picture,
			version: this.version,
			statistics: statistics(this.isMixed ? this.groups.mixed() : picture.halves, picture.components)
		};
		return this.known.statistics;
	}
	/** What the picture is shown with, and how, as the shader counts. */
	compared() {
		const other = this.layer === "picture" ? this.others.shown(this.comparison === "map" ? "map" : "reference") : null;
		const way = {
			off: 0,
			split: 1,
			flip: this.showsOther ? 2 : 0,
			difference: 3,
			map: 4
		}[this.comparison];
		return other ? [way, other] : [0, null];
	}
	/** Whether the map of differences is shown. */
	get showsMap() {
		return this.compared()[0] === 4;
	}
	/** The scale of false colour, when that's shown. */
	scale() {
		const found = this.isFalse ? this.statistics() : null;
		return found && scaleEnds(found);
	}
	/** The shown values at a pixel of the film. */
	values(x, y) {
		const picture = this.picture;
		if (!picture) return null;
		const [x0, y0, x1, y1] = picture.crop;
		if (x < x0 || y < y0 || x >= x1 || y >= y1) return null;
		const column = Math.floor((x - x0) * picture.width / (x1 - x0));
		const line = Math.floor((y - y0) * picture.height / (y1 - y0));
		if (this.isMixed) return this.groups.at(line * picture.width + column);
		const at = (line * picture.width + column) * picture.components;
		return Array.from(picture.halves.subarray(at, at + picture.components), (bits) => VALUES[bits]);
	}
	/** The pixel of the film at a place of the window, in CSS pixels; also outside of the film. */
	pixelAt(clientX, clientY) {
		const [x, y] = this.devicePixel(clientX, clientY);
		const [u, v] = this.placement.pixelAt(x, y);
		return [Math.floor(u), Math.floor(v)];
	}
	/** Device pixels of the canvas at a place of the window. */
	devicePixel(clientX, clientY) {
		const box = this.canvas.getBoundingClientRect();
		return [(clientX - box.left) * devicePixelRatio, (clientY - box.top) * devicePixelRatio];
	}
	/** Draws before the next frame of the screen. */
	redraw() {
		this.queued ||= requestAnimationFrame(() => {
			this.queued = 0;
			this.draw();
		});
	}
	draw() {
		const { gl, canvas, placement } = this;
		const width = Math.max(1, Math.round(canvas.clientWidth * devicePixelRatio));
		const height = Math.max(1, Math.round(canvas.clientHeight * devicePixelRatio));
		if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, {
			width,
			height
		});
		placement.update(canvas, this.film);
		gl.viewport(0, 0, width, height);
		gl.clearColor(0, 0, 0, 0);
		gl.clear(gl.COLOR_BUFFER_BIT);
		const picture = this.picture;
		if (picture) {
			gl.useProgram(this.program);
			gl.bindTexture(gl.TEXTURE_2D, picture.texture);
			this.setUniforms(picture);
			const { left, top, scale } = placement;
			const [x0, y0, x1, y1] = picture.crop;
			const [x, y] = [Math.floor(left + x0 * scale), Math.floor(top + y0 * scale)];
			const [right, bottom] = [Math.ceil(left + x1 * scale), Math.ceil(top + y1 * scale)];
			gl.enable(gl.SCISSOR_TEST);
			gl.scissor(x, height - bottom, right - x, bottom - y);
			gl.drawArrays(gl.TRIANGLES, 0, 3);
			gl.disable(gl.SCISSOR_TEST);
		}
		this.drawn();
	}
	setUniforms(picture) {
		const { gl, canvas, placement, tone } = this;
		const { left, top, scale } = placement;
		const [x0, y0, x1, y1] = picture.crop;
		const shown = [(x1 - x0) * scale, (y1 - y0) * scale];
		const [way, other] = this.compared();
		const [ox0, oy0, ox1, oy1] = (other ?? picture).crop;
		gl.activeTexture(gl.TEXTURE1);
		gl.bindTexture(gl.TEXTURE_2D, (other ?? picture).texture);
		gl.activeTexture(gl.TEXTURE2);
		gl.bindTexture(gl.TEXTURE_2D_ARRAY, this.groups.texture);
		gl.activeTexture(gl.TEXTURE0);
		gl.uniform1i(this.at("other"), 1);
		gl.uniform1i(this.at("groups"), 2);
		gl.uniform1i(this.at("groupCount"), this.isMixed ? this.groups.names.length : 0);
		if (this.isMixed) gl.uniform3fv(this.at("weights"), this.groups.weights);
		gl.uniform2f(this.at("otherCorner"), left + ox0 * scale, top + oy0 * scale);
		gl.uniform2f(this.at("otherSize"), (ox1 - ox0) * scale, (oy1 - oy0) * scale);
		gl.uniform1i(this.at("comparison"), way);
		gl.uniform1f(this.at("split"), this.split * canvas.width);
		gl.uniform1f(this.at("differenceGain"), this.differenceGain);
		const gain = Math.fround(2 ** tone.exposure);
		const maximum = tone.name.startsWith("equalize") && !this.isFalse ? Math.min((this.statistics()?.maximum ?? 1) * gain, 1e9) : 1;
		gl.uniform2f(this.at("canvasSize"), canvas.width, canvas.height);
		gl.uniform2f(this.at("corner"), left + x0 * scale, top + y0 * scale);
		gl.uniform2f(this.at("shownSize"), ...shown);
		gl.uniform1i(this.at("isGrey"), Number(picture.components === 1));
		gl.uniform1i(this.at("isNearest"), Number(shown[0] >= picture.width && picture.width >= x1 - x0));
		gl.uniform1i(this.at("isFalse"), Number(this.isFalse));
		gl.uniform1i(this.at("isMarked"), Number(this.isMarked));
		gl.uniform1f(this.at("gain"), gain);
		gl.uniform1i(this.at("curve"), Math.max(0, CURVES.indexOf(tone.name)));
		gl.uniform2f(this.at("values"), tone.values[0] ?? 1, tone.values[1] ?? 1);
		gl.uniform1f(this.at("maximum"), Math.max(maximum, 12e-39));
		gl.uniform2f(this.at("scaleEnds"), ...this.scale() ?? [1, 10]);
	}
	at(name) {
		if (!this.uniforms.has(name)) this.uniforms.set(name, this.gl.getUniformLocation(this.program, name));
		return this.uniforms.get(name);
	}
};
// src/stage.ts
/** The picture with what lies over it, the camera that it is seen by, and the pointer on it. */
/** Milliseconds without a movement by a key after which it has ended. */
var STOP = 150;
var Stage = class {
	connection;
	canvas = h("canvas", {
		class: "picture",
		tabindex: 0,
		role: "img",
		"aria-label": "Rendered picture; arrow keys orbit the camera"
	});
	view = new View(this.canvas);
	camera = new Camera();
	moving;
	overlay = new Overlay(this.view);
	legend = new Legend();
	path;
	inspector;
	pick;
	selection;
	toolbar;
	flying = h("div", {
		class: "hint",
		hidden: true
	}, "Flying: W A S D Q E and the mouse; Escape ends");
	/** Called when there is another theme. */
	themed = () => {};
	flight;
	constructor(connection, actions) {
		this.connection = connection;
		const { view, overlay } = this;
		this.moving = new Moving(this.camera, (message) => connection.send(message));
		this.flight = new Fly(this.canvas, this.camera, this.moving);
		this.flight.changed = (on) => this.flying.hidden = !on;
		this.path = new Path(overlay.drawing, () => this.inspector.set([view.film.width >> 1, view.film.height >> 1]));
		this.inspector = new Inspector(this.path, () => {
			overlay.pin = this.inspector.pinned;
			overlay.place();
		});
		this.selection = new Selection(overlay.outline, overlay.gizmo);
		this.inspector.told = (pixel) => this.selection.take(pixel);
		this.pick = new Pick(this.camera, this.move, this.send, actions.tell);
		this.toolbar = new Toolbar({
			fit: () => (view.placement.fit(), view.redraw()),
			actual: () => (view.placement.actual(), view.redraw()),
			pause: (on) => this.send({
				type: "pause",
				on
			}) && this.toolbar.setPaused(on),
			clearRegion: () => this.send({
				type: "region",
				pixels: null
			}),
			help: actions.help,
			panel: () => this.toolbar.setPanel(document.body.classList.toggle("no-panel")),
			themed: () => this.themed()
		});
		view.drawn = () => this.drawn();
		this.navigate();
	}
	/** Sends; what asks for another camera ends the movement of this one. */
	send = (message) => {
		if ([
			"camera-name",
			"camera-reset",
			"undo",
			"redo"
		].includes(message.type)) this.moving.release();
		return this.connection.send(message);
	};
	/** Moves the camera, if it may be moved. */
	move = (change) => {
		if (!this.isMovable) return;
		change();
		this.moving.moved();
		this.moving.stop(STOP);
	};
	from = (side, opposite = false) => this.move(() => this.camera.from(side, opposite));
	fly = () => {
		if (this.isMovable) this.flight.start();
	};
	focus = () => {
		const { state } = this.connection;
		if (state) this.pick.focus(state.camera);
	};
	get isMovable() {
		return this.connection.state?.camera.movable ?? false;
	}
	navigate() {
		const { view, overlay, inspector, path, pick, selection, toolbar } = this;
		const click = (pixel) => {
			const inside = view.values(...pixel) !== null;
			if (!inside) selection.set(null);
			else if (!path.isOn) selection.click();
			inspector.set(inside ? pixel : null);
			if (inside) inspector.show(pixel, view.values(...pixel), view.isMixed);
		};
		overlay.gizmo.clicked = (x, y) => click(view.pixelAt(x, y));
		new Navigate(view, this.camera, this.moving, this.flight, {
			hover: (pixel) => {
				pick.pixel = pixel;
				inspector.show(pixel, pixel && view.values(...pixel), view.isMixed);
			},
			click,
			region: (a, b, done) => {
				overlay.region = regionOf(a, b, view.film);
				overlay.place();
				if (!done) return;
				toolbar.setRegion(false);
				if (overlay.region) this.send({
					type: "region",
					pixels: overlay.region
				});
				else overlay.region = this.connection.state?.region ?? null;
			},
			drawsRegion: () => toolbar.region,
			isMovable: () => this.isMovable
		});
	}
	drawn() {
		const { view } = this;
		this.overlay.place();
		const isPicture = view.layer === "picture";
		const ends = view.scale();
		if (view.showsMap) this.legend.update(FLIP_SCALE);
		else this.legend.update(ends && falseScale(ends, isPicture ? 72983.26 : 1, isPicture ? "cd/m²" : ""));
	}
	takeState(state) {
		this.view.film = { ...state.film };
		this.view.region = state.region;
		this.path.update(state);
		this.selection.state(state);
	}
	takeFields(state, isNew) {
		if (!this.toolbar.region) this.overlay.region = state.region;
		this.moving.state(state.generation, state.camera, isNew);
		this.toolbar.update(state);
		this.overlay.place();
	}
	takeTile(tile) {
		const { view } = this;
		if (tile.layer >= 256) return view.groups.tile(tile.layer - 256, tile);
		const layer = tile.layer === 0 ? "picture" : this.connection.state?.layers[tile.layer - 1];
		if (layer !== void 0) view.tile(layer, tile);
	}
	takeFrame(frame) {
		this.view.frame(frame);
		this.moving.frame(frame.generation);
		this.selection.frame(frame);
	}
};
// src/main.ts
function start() {
	trackEditing();
	const connection = new Connection();
	const stage = new Stage(connection, {
		tell: (message) => panels.tell(message),
		help: () => keys.toggle()
	});
	const panels = new Panels(stage);
	const drop = new Drop(panels.tell);
	const help = () => keys.toggle();
	const keys = new Keys(bindings({
		...stage,
		look: panels.look,
		compare: panels.compare,
		help
	}));
	let isFirst = true;
	const takeState = (state, isNew) => {
		const { view } = stage;
		document.title = `${state.scene.name} – Steradian`;
		stage.takeState(state);
		panels.takeState(state);
		const isForgotten = view.layer !== "picture" && !state.layers.includes(view.layer);
		if (isNew && !isFirst && isForgotten) stage.send({
			type: "layers",
			names: [view.layer]
		});
		isFirst = false;
		view.redraw();
	};
	connection.open({
		state: takeState,
		fields: (state, isNew) => {
			stage.takeFields(state, isNew);
			panels.takeFields(state, isNew);
		},
		frame: (frame) => {
			stage.takeFrame(frame);
			panels.takeFrame(frame);
			stage.inspector.refresh();
		},
		tile: (tile) => stage.takeTile(tile),
		other: (message) => {
			if (message.type === "message") panels.tell(message);
			else if (message.type === "reference") panels.compare.changedElsewhere();
		}
	});
	document.body.append(h("main", { class: "stage" }, h("h1", { class: "hidden" }, "Steradian"), stage.canvas, stage.overlay.element, panels.compare.divider.element, panels.compare.tag, stage.toolbar.element, stage.legend.element, stage.flying, panels.messages.toast, drop.hint), connection.status.element, panels.element, keys.help);
	stage.toolbar.setPanel(document.body.classList.toggle("no-panel", innerWidth < 720));
}
try {
	start();
} catch (error) {
	document.body.append(h("p", {
		class: "fatal",
		role: "alert"
	}, `The page cannot run: ${error instanceof Error ? error.message : String(error)}`));
}
