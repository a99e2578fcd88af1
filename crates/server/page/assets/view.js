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
var place = (...codes) => (event) => !event.altKey && codes.includes(event.code);
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
	/** `pointer` is what the pointer does, for the list. */
	constructor(keys, pointer = POINTER) {
		this.keys = keys;
		const rows = (list) => list.map(([key, doc]) => h("div", {}, h("dt", {}, h("kbd", {}, key)), h("dd", {}, doc)));
		const groups = [
			"Picture",
			"Camera",
			"Render"
		].flatMap((group) => {
			const list = keys.filter((k) => k.group === group).map((k) => [k.shown, k.doc]);
			return list.length === 0 ? [] : h("section", {}, h("h3", {}, group), h("dl", {}, ...rows(list)));
		});
		const close = h("button", {
			onclick: () => this.help.close(),
			"aria-label": "Close"
		}, "Close");
		this.help = h("dialog", {
			class: "help",
			"aria-labelledby": "help-title"
		}, h("header", {}, h("h2", { id: "help-title" }, "Keys and pointer"), close), h("div", { class: "columns" }, h("section", {}, h("h3", {}, "Pointer"), h("dl", {}, ...rows(pointer))), ...groups));
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
// src/picturekeys.ts
function pictureKeys({ view, look, compare, panel, help }) {
	const key = (shown, doc, is, act) => ({
		shown,
		doc,
		group: "Picture",
		is,
		act
	});
	const place = (change) => (change(), view.redraw());
	const zoom = (factor) => place(() => view.placement.zoom(factor));
	return [
		key("[  ]", "exposure by half an EV", character("[", "]"), (e) => look.expose(view.tone.exposure + (e.key === "[" ? -.5 : .5))),
		key("\\", "exposure 0", character("\\"), () => look.expose(0)),
		key("+  −", "zoom", character("+", "=", "-"), (e) => zoom(e.key === "-" ? 1 / 1.5 : 1.5)),
		key("F", "fit the picture into the window", character("f"), () => place(() => view.placement.fit())),
		key("1", "one pixel for each pixel", character("1"), () => place(() => view.placement.actual())),
		key("C", "false colour", character("c"), () => look.setFalse(!view.isFalse)),
		key("L", "next layer; with Shift the one before", character("l", "L"), (e) => look.stepLayer(e.shiftKey ? -1 : 1)),
		key("B", "picture A or B, the one it is compared with", character("b"), () => compare.alternate()),
		key("N", "show or hide the panel", character("n"), panel),
		key("?", "this list", character("?"), help)
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
// src/drop.ts
/** Files dropped on the page are opened: models or scenes with what belongs to them, folders too; a picture becomes the environment map. */
var Drop = class {
	tell;
	opened;
	hint;
	/** `hint` says what may be dropped; `opened` is given the server's answer. */
	constructor(tell, hint = "Drop a model or a scene with what belongs to it, or an environment map", opened = () => {}) {
		this.tell = tell;
		this.opened = opened;
		this.hint = h("div", {
			class: "drop",
			hidden: true
		}, hint);
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
			if (response.ok) this.opened(answer);
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
// src/flipmap.ts
var FlipMap = class {
	view;
	tone;
	fetch;
	told;
	isBusy = false;
	isStale = false;
	turn = 0;
	/** `told` is given the figures, or why there are none. */
	constructor(view, tone, fetch, told) {
		this.view = view;
		this.tone = tone;
		this.fetch = fetch;
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
			const { head, tiles } = await this.fetch(this.tone(), this.view.tone.exposure);
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
var MOST$1 = 1e4;
function numberField(options) {
	const { label, range, whole = false, unit = "", change } = options;
	const [low, high] = (options.slider ?? range ?? []).map((v) => v ?? NaN);
	const ends = low !== void 0 && high !== void 0 && low < high && high - low <= MOST$1 ? [low, high] : null;
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
	source;
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
	map;
	tones = [];
	/** Why there is no B. */
	fault = "";
	timer = 0;
	/** Number of the last question for B. */
	turn = 0;
	isPreview = true;
	constructor(view, tell, source) {
		this.view = view;
		this.tell = tell;
		this.source = source;
		this.divider = new Divider((part) => {
			view.split = part;
			view.redraw();
		});
		this.map = new FlipMap(view, () => toneText(view.tone, this.tones), source.flip, (figures) => this.showFigures(figures));
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
		this.element = section("Compare", false, this.facts, ...source.controls((change) => void this.act(change)), row("Show", this.mode), this.gain, this.automaticRow, this.figures);
		this.update();
		this.take();
	}
	/** The tone curves, or the film, may have changed. */
	takeTones(tones) {
		this.tones = tones;
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
		if (!this.acts) this.take();
	}
	/** Carries out what changes B, and takes the new one. */
	async act(change) {
		this.acts = true;
		try {
			await change();
			await this.take();
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
	async take() {
		const turn = ++this.turn;
		let fault = "";
		const found = await this.source.fetch().catch((error) => {
			fault = error instanceof Error ? error.message : String(error);
			return null;
		});
		if (turn !== this.turn) return;
		this.fault = fault;
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
		if (!about) setText(this.facts, this.fault || "Nothing is kept as B.");
		this.mode.disabled = about === null;
		this.source.update?.(about !== null);
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
var KEPT = 100;
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
		this.own = [message, ...this.own].slice(0, KEPT);
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
/** An answer that does not refuse. */
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
/** B as the server keeps it: the shown picture as it was, or a file. */
function keptReference() {
	const clear = h("button", { disabled: true }, "Clear B");
	return {
		fetch: fetchReference,
		flip: fetchFlip,
		controls: (act) => {
			const file = h("input", {
				type: "file",
				hidden: true,
				tabindex: -1,
				"aria-label": "Picture to load as B"
			});
			file.addEventListener("change", () => {
				const chosen = file.files?.[0];
				file.value = "";
				if (chosen) act(() => keepReference(chosen));
			});
			const load = h("button", {
				title: "EXR, PNG, HDR, PFM, JPEG, …",
				onclick: () => file.click()
			}, "Load B");
			const keep = h("button", {
				title: "Keep the picture as it is now",
				onclick: () => act(() => keepReference(null))
			}, "Keep as B");
			clear.addEventListener("click", () => act(clearReference));
			return [h("div", { class: "buttons" }, keep, load, clear, file)];
		},
		update: (hasOther) => clear.disabled = !hasOther
	};
}
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
/** cd/m² of a luminance of 1 W/(m² sr nm): the integral of CIE ȳ times 683 lm/W. */
var WHITE = 72983.26;
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
		this.pin.replaceChildren(this.head([pixel.x, pixel.y]), channelTable(pixel.channels, facts));
	}
};
/** A table of a pixel's channels, those of a layer (`albedo.R`) in one row, and of facts. */
function channelTable(channels, facts = []) {
	const rows = /* @__PURE__ */ new Map();
	for (const [name, value] of Object.entries(channels)) {
		const dot = name.lastIndexOf(".");
		const layer = dot < 0 ? /^[RGB]$/.test(name) ? "picture" : name : name.slice(0, dot);
		rows.set(layer, [...rows.get(layer) ?? [], text(value)]);
	}
	const line = (name, values) => h("tr", {}, h("th", { scope: "row" }, name), h("td", {}, values.join("  ")));
	return h("table", {}, h("tbody", {}, ...[...rows].map(([n, v]) => line(n, v)), ...facts.map(([n, v]) => line(n, [v]))));
}
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
// src/navigate.ts
/** CSS pixels that a click may move. */
var STILL = 4;
var Navigate = class {
	view;
	hands;
	actions;
	drag = null;
	start = [0, 0];
	last = [0, 0];
	isClick = false;
	touches = /* @__PURE__ */ new Map();
	constructor(view, hands, actions) {
		this.view = view;
		this.hands = hands;
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
		if (this.hands?.fly.on) return this.hands.fly.stop();
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
		if (this.hands?.fly.on) return this.hands.fly.look(event.movementX, event.movementY);
		if (event.pointerType !== "touch") this.actions.hover(this.view.pixelAt(...at));
		if (!this.drag) return;
		if (Math.hypot(at[0] - this.start[0], at[1] - this.start[1]) > STILL) this.isClick = false;
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
		if (this.drag === "orbit") this.hands?.camera.orbit(dx, dy);
		else this.hands?.camera.pan(dx, dy, this.pictureSize());
		this.hands?.moving.moved();
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
		if (event.type === "pointercancel") this.hands?.moving.stop();
		else if (drag === "region") this.actions.region(this.view.pixelAt(...this.start), this.view.pixelAt(...at), true);
		else if (this.isClick) this.actions.click(this.view.pixelAt(...at));
		else this.hands?.moving.stop();
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
			this.hands?.camera.pan(dx, dy, this.pictureSize());
			this.hands?.camera.dolly(apart(before) / apart(at));
			this.hands?.moving.moved();
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
		if (this.hands?.fly.on) return this.hands.fly.wheel(delta);
		if (event.ctrlKey || event.metaKey || !this.actions.isMovable()) {
			const factor = Math.exp(-Math.max(-100, Math.min(100, delta)) * .003);
			this.view.placement.zoom(factor, ...this.view.devicePixel(event.clientX, event.clientY));
			return this.view.redraw();
		}
		this.hands?.camera.dolly(Math.exp(delta * .001));
		this.hands?.moving.moved();
		this.hands?.moving.stop(250);
	}
	/** The picture's smaller side, CSS pixels. */
	pictureSize() {
		const { film, placement } = this.view;
		return Math.min(film.width, film.height) * placement.scale / devicePixelRatio;
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
// src/placement.ts
/** Where the picture lies on the canvas: fitted, or zoomed and moved. Lengths are in device pixels. */
var LEAST = 1 / 16;
var MOST = 128;
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
uniform bool isGrey, isOtherGrey, isNearest, isFalse, isMarked;
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
  if (isGrey) v = v.rrr;
  vec3 o = comparison > 0 ? colorAt(other, atOther) : v;
  if (isOtherGrey) o = o.rrr;
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
/** The number of a picture's pixel at a pixel of the film; `null` outside of it. */
function indexIn({ crop: [x0, y0, x1, y1], width, height }, x, y) {
	if (x < x0 || y < y0 || x >= x1 || y >= y1) return null;
	return Math.floor((y - y0) * height / (y1 - y0)) * width + Math.floor((x - x0) * width / (x1 - x0));
}
/** A picture's values at a pixel of the film; `null` outside of it. */
function valuesIn(picture, x, y) {
	const { components, halves } = picture;
	const pixel = indexIn(picture, x, y);
	return pixel === null ? null : Array.from(halves.subarray(pixel * components, (pixel + 1) * components), (bits) => VALUES[bits]);
}
var View = class {
	canvas;
	placement = new Placement();
	layers;
	/** `reference`, the picture's other one, and `map`, of how far they are apart. */
	others;
	/** The light of each group of lights, where the server sends it. */
	groups;
	comparison = "off";
	/** True if the other one has the shown layer, too, and not the picture alone. */
	comparesLayers = false;
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
	/** Pixels of the longest edge of a picture that can be drawn. */
	get longest() {
		return this.gl.getParameter(this.gl.MAX_TEXTURE_SIZE);
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
		const other = this.comparesLayers || this.layer === "picture" ? this.others.shown(this.comparison === "map" ? "map" : "reference") : null;
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
		const pixel = indexIn(picture, x, y);
		if (pixel !== null && this.isMixed) return this.groups.at(pixel);
		return valuesIn(picture, x, y);
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
		gl.uniform1i(this.at("isOtherGrey"), Number(other?.components === 1));
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
export { section as A, pictureKeys as C, h as D, place as E, show as F, trackEditing as I, setPressed as M, setText as N, isPressed as O, setValue as P, parseTile as S, character as T, VALUES as _, FLIP_SCALE as a, numberField as b, Legend as c, checked as d, keptReference as f, Histogram as g, Look as h, Navigate as i, setOptions as j, row as k, WHITE as l, Messages as m, valuesIn as n, Inspector as o, parsePieces as p, themeButton as r, channelTable as s, View as t, falseScale as u, Compare as v, Keys as w, Drop as x, toneText as y };
