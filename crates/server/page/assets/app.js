import { A as section, C as pictureKeys, D as h, E as place$1, F as show, I as trackEditing, M as setPressed, N as setText, O as isPressed, P as setValue, S as parseTile, T as character, _ as VALUES, a as FLIP_SCALE, b as numberField, c as Legend, f as keptReference, g as Histogram, h as Look, i as Navigate, j as setOptions, k as row, m as Messages, o as Inspector, r as themeButton, t as View, u as falseScale, v as Compare, w as Keys, x as Drop, y as toneText } from "./view.js";
// src/bindings.ts
/** CSS pixels of a drag that an arrow key stands for. */
var STEP = 20;
function bindings({ view, camera, toolbar, look, compare, inspector, pick, selection, path, focus, move, from, fly, send, help }) {
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
		...pictureKeys({
			view,
			look,
			compare,
			panel: () => toolbar.press("panel"),
			help
		}),
		{
			shown: "T",
			doc: "draw the path of a sample of the pinned pixel",
			group: "Picture",
			is: character("t"),
			act: () => path.toggle()
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
var WIDTH = 294;
var HEIGHT = 190;
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
function text$1(v) {
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
		viewBox: `0 0 ${WIDTH} ${HEIGHT}`,
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
	}, text$1(v)));
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
	}, text$1(v)));
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
var PAUSE = 250;
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
		if (this.convergence.take(frame, this.state?.settings.integrator || "the scene’s", () => this.toReference()) && !this.timer) this.timer = window.setTimeout(() => this.draw(), PAUSE);
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
// src/mixer.ts
/** Panel "Light groups": how bright, and of which colour, each group of lights is shown. Only the switch asks for a render. */
/** Stops by which a group is brightened or dimmed at most. */
var STOPS = 6;
var WHITE = "#ffffff";
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
			const attributes = {
				class: "small",
				title,
				"aria-label": `${name}: ${what}`,
				"aria-pressed": "false",
				onclick: press
			};
			const button = h("button", attributes, letter);
			return button;
		};
		this.mute = toggle("M", "mute", "Mute: put this group out");
		this.solo = toggle("S", "solo", "Solo: put all groups out that are not solo");
		this.color = h("input", {
			type: "color",
			value: WHITE,
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
		this.color.value = WHITE;
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
		text
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
function text(p, label, edit) {
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
var MOST = 32;
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
		this.keep.disabled = at >= 0 || kept.length >= MOST;
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
/** Words of the ground, by "" where the scene has it as usual. */
var GROUNDS = [
	{
		value: "",
		text: "usual"
	},
	{
		value: "true",
		text: "grey"
	},
	{
		value: "shadow",
		text: "its shadow alone"
	},
	{
		value: "false",
		text: "none"
	}
];
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
	ground = this.choice("ground", "Ground");
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
		setOptions(this.ground, GROUNDS);
		setValue(this.ground, defines["ground"] ?? "");
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
		this.compare = new Compare(view, this.tell, keptReference());
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
		this.compare.takeTones(state.choices.tones);
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
	const isGrey = rgb[0] === rgb[1] && rgb[1] === rgb[2];
	return h("td", { class: "rgb" }, ...(isGrey ? [rgb[0]] : rgb).map((v) => h("span", {}, number(v))));
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
		new Navigate(view, {
			camera: this.camera,
			moving: this.moving,
			fly: this.flight
		}, {
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
