import { A as section, C as pictureKeys, D as h, E as place, F as show, I as trackEditing, N as setText, a as FLIP_SCALE, c as Legend, d as checked, g as Histogram, h as Look, i as Navigate, j as setOptions, k as row, m as Messages, n as valuesIn, p as parsePieces, r as themeButton, s as channelTable, t as View, u as falseScale, v as Compare, w as Keys, x as Drop } from "./view.js";
// src/album.ts
var json = async (address) => (await checked(await fetch(address))).json();
var fetchLook = () => json("./api/look");
/** The list, after the server has looked for changed files. */
var fetchList = () => json("./api/pictures");
/** All channels of a pixel. */
var fetchPixel = (id, [x, y]) => json(`./api/pixel?id=${id}&x=${x}&y=${y}`);
/** A layer of a picture; `null` where it has none of that name. */
async function fetchPicture(id, layer) {
	const response = await fetch(`./api/picture?${new URLSearchParams({
		id: String(id),
		layer
	})}`);
	if (response.status === 404 && layer !== "picture") return null;
	return parsePieces(await (await checked(response)).arrayBuffer());
}
/** The map of FLIP errors of what is displayed of a layer. */
async function fetchFlip(a, b, layer, tone, exposure) {
	const query = new URLSearchParams({
		a: String(a),
		b: String(b),
		layer,
		metric: "flip",
		tone,
		exposure: String(exposure)
	});
	return parsePieces(await (await checked(await fetch(`./api/difference?${query}`))).arrayBuffer());
}
// src/list.ts
/** Panel "Pictures": the list, with what is wrong with files, and a filter. */
var List = class {
	choose;
	element;
	chosen = null;
	filter = h("input", {
		type: "search",
		placeholder: "Filter",
		"aria-label": "Filter the pictures"
	});
	items = h("div", {
		class: "pictures",
		role: "listbox",
		tabindex: 0,
		"aria-label": "Pictures"
	});
	facts = h("p", { class: "facts" });
	listings = [];
	told = "";
	/** `choose` is told of the picture that was chosen here. */
	constructor(choose) {
		this.choose = choose;
		this.filter.addEventListener("input", () => this.fill());
		this.filter.addEventListener("keydown", (event) => {
			const by = {
				ArrowUp: -1,
				ArrowDown: 1
			}[event.key];
			if (by === void 0) return;
			event.preventDefault();
			this.step(by);
		});
		this.element = section("Pictures", true, this.filter, this.items, this.facts);
	}
	update(listings) {
		this.listings = listings;
		this.fill();
	}
	/** Marks the picture that is shown. */
	mark(id) {
		this.chosen = id;
		this.fill();
		this.items.querySelector("[aria-selected=\"true\"]")?.scrollIntoView({ block: "nearest" });
	}
	/** The next or previous picture of those that the filter leaves. */
	step(by) {
		const found = this.found();
		if (found.length === 0) return;
		const at = found.findIndex(({ id }) => id === this.chosen);
		this.choose(found[at < 0 ? 0 : (at + by + found.length) % found.length].id);
	}
	found() {
		const words = this.filter.value.toLowerCase().split(/\s+/);
		return this.listings.filter(({ name }) => words.every((word) => name.toLowerCase().includes(word)));
	}
	fill() {
		const found = this.found();
		const told = JSON.stringify([found, this.chosen]);
		if (told === this.told) return;
		this.told = told;
		this.items.replaceChildren(...found.map((listing) => this.item(listing)));
		if (found.some(({ id }) => id === this.chosen)) this.items.setAttribute("aria-activedescendant", `picture-${this.chosen}`);
		else this.items.removeAttribute("aria-activedescendant");
		setText(this.facts, found.length === this.listings.length ? `${found.length} in all` : `${found.length} of ${this.listings.length}`);
	}
	item({ id, name, fault }) {
		const option = {
			class: "item",
			role: "option",
			id: `picture-${id}`,
			title: name,
			"aria-selected": String(id === this.chosen)
		};
		return h("div", {
			...option,
			onclick: () => this.choose(id)
		}, h("div", { class: "id" }, h("bdi", {}, name)), fault === null ? null : h("div", { class: "fault" }, fault));
	}
};
// src/numbers.ts
/** Numbers in the pixels of a picture that is enlarged a lot, and the mark of the pinned one. */
/** CSS pixels of the smallest pixel with numbers in it. */
var LEAST = 38;
var COLORS = [
	"#ffb0a8",
	"#b4f0a6",
	"#b5cdff"
];
var Numbers = class {
	view;
	element = h("canvas", {
		class: "pixel-numbers",
		"aria-hidden": "true"
	});
	pin = null;
	constructor(view) {
		this.view = view;
	}
	/** Draws anew, where the picture is. */
	draw() {
		const { element, view } = this;
		const { canvas, placement, film } = view;
		const { left, top, scale } = placement;
		const { width, height } = canvas;
		if (element.width !== width || element.height !== height) Object.assign(element, {
			width,
			height
		});
		const context = element.getContext("2d");
		context.clearRect(0, 0, width, height);
		const cell = scale / devicePixelRatio;
		let count = 0;
		if (cell >= LEAST) {
			const range = (start, room, size) => [Math.max(0, Math.floor(-start / scale)), Math.min(size, Math.ceil((room - start) / scale))];
			const [x0, x1] = range(left, width, film.width);
			const [y0, y1] = range(top, height, film.height);
			context.font = `${Math.min(12, cell / 4) * devicePixelRatio}px system-ui, sans-serif`;
			Object.assign(context, {
				textAlign: "center",
				textBaseline: "middle",
				lineJoin: "round",
				strokeStyle: "#000"
			});
			context.lineWidth = 3 * devicePixelRatio;
			for (let y = y0; y < y1; y++) for (let x = x0; x < x1; x++) {
				const values = this.at(x, y);
				if (!values) continue;
				count++;
				values.forEach((v, i) => {
					const text = brief(v);
					const [u, w] = [left + (x + .5) * scale, top + (y + (i + 1) / (values.length + 1)) * scale];
					context.strokeText(text, u, w, scale - 4 * devicePixelRatio);
					context.fillStyle = values.length === 3 ? COLORS[i] : "#fff";
					context.fillText(text, u, w, scale - 4 * devicePixelRatio);
				});
			}
		}
		element.dataset.numbered = String(count);
		if (this.pin) this.mark(context, this.pin);
	}
	/** Values shown of a pixel: of A, of B, or how far they are apart. */
	at(x, y) {
		const { view } = this;
		const a = view.values(x, y);
		const [way, other] = view.compared();
		const b = other && valuesIn(other, x, y);
		if (!a || !b || way === 0) return a;
		const isRight = view.placement.left + (x + .5) * view.placement.scale >= view.split * view.canvas.width;
		if (way === 3) return a.map((v, i) => v - (b[i] ?? b[0]));
		return way === 1 && !isRight ? a : b;
	}
	mark(context, [x, y]) {
		const { left, top, scale } = this.view.placement;
		const size = Math.max(scale, 9 * devicePixelRatio);
		for (const [color, out] of [["#000", 1], ["#fff", 0]]) {
			Object.assign(context, {
				strokeStyle: color,
				lineWidth: devicePixelRatio
			});
			context.strokeRect(left + x * scale - out - .5, top + y * scale - out - .5, size + 2 * out, size + 2 * out);
		}
	}
};
/** A number of three digits. */
function brief(v) {
	if (!Number.isFinite(v)) return Number.isNaN(v) ? "NaN" : v > 0 ? "∞" : "−∞";
	const short = Number(v.toPrecision(3));
	return short !== 0 && (Math.abs(short) < .001 || Math.abs(short) >= 1e6) ? short.toExponential() : String(short);
}
// src/pixelpanel.ts
/** Panel "Pixel" of finished pictures: all channels of the pixel under the pointer, or of the one that is pinned. */
var HINT = "Point at the picture; click to pin a pixel.";
var PixelPanel = class {
	picture;
	changed;
	element;
	pinned = null;
	hover = h("p", { class: "values" }, HINT);
	table = h("div", { class: "pin" });
	isBusy = false;
	next = null;
	/** `picture` is the number of the one that is shown. */
	constructor(picture, changed) {
		this.picture = picture;
		this.changed = changed;
		this.element = section("Pixel", true, this.hover, this.table);
	}
	/** Values under the pointer. */
	show(pixel, values) {
		setText(this.hover, pixel && values ? `${pixel[0]}, ${pixel[1]}:  ${values.map(show).join("  ")}` : HINT);
		if (pixel && values && !this.pinned) this.ask(pixel);
	}
	pin(pixel) {
		this.pinned = pixel;
		this.table.replaceChildren();
		if (pixel) this.ask(pixel);
		this.changed();
	}
	/** There is another picture. */
	refresh() {
		this.table.replaceChildren();
		if (this.pinned) this.ask(this.pinned);
	}
	/** Asks for a pixel, once the question before is answered. */
	ask(pixel) {
		this.next = pixel;
		if (!this.isBusy) this.answer();
	}
	async answer() {
		this.isBusy = true;
		for (let pixel = this.next; pixel; pixel = this.next) {
			this.next = null;
			const id = this.picture();
			if (id === null) break;
			const found = await fetchPixel(id, pixel).catch((error) => String(error instanceof Error ? error.message : error));
			if (this.next || id !== this.picture()) continue;
			const content = typeof found === "string" ? h("p", { class: "facts" }, found) : channelTable(found.channels);
			this.table.replaceChildren(this.head(pixel), content);
		}
		this.isBusy = false;
	}
	head([x, y]) {
		const unpin = this.pinned ? h("button", {
			class: "small",
			title: "Unpin the pixel",
			"aria-label": "Unpin the pixel",
			onclick: () => this.pin(null)
		}, "×") : null;
		return h("div", { class: "pin-head" }, h("strong", {}, `Pixel ${x}, ${y}`), unpin);
	}
};
// src/pictures.ts
/** Milliseconds between two looks for changed files. */
var PAUSE = 1e3;
var POINTER = [
	["Drag, one finger", "move the picture"],
	["Wheel, two fingers", "zoom; far in, pixels have their numbers"],
	["Click", "pin a pixel"]
];
var Pictures = class {
	first;
	canvas = h("canvas", {
		class: "picture",
		tabindex: 0,
		role: "img",
		"aria-label": "Picture; up and down choose another"
	});
	view = new View(this.canvas);
	numbers = new Numbers(this.view);
	legend = new Legend();
	messages = new Messages();
	histogram = new Histogram();
	list = new List((id) => this.choose(id));
	pixel = new PixelPanel(() => this.about?.id ?? null, () => {
		this.numbers.pin = this.pixel.pinned;
		this.view.redraw();
	});
	look;
	compare;
	other = h("select", { "aria-label": "Picture B" });
	lost = h("span", { role: "status" });
	facts = h("span", { class: "status-facts" });
	status = h("footer", { class: "status" }, h("span", {
		class: "dot",
		"aria-hidden": "true"
	}), this.lost, this.facts);
	/** The picture in view. */
	about = null;
	listings = [];
	/** The picture, and the version of it, that was asked for last. */
	asked = null;
	turn = 0;
	/** B as it was fetched last. */
	kept = null;
	constructor(first) {
		this.first = first;
		const { view } = this;
		view.comparesLayers = true;
		this.look = new Look(view, () => void this.show(), () => {
			this.showHistogram();
			this.compare.refresh();
		});
		this.compare = new Compare(view, this.tell, this.source());
		this.compare.takeTones(first.tones);
		this.compare.takeFrame({ kind: "render" });
		this.histogram.element.addEventListener("toggle", this.showHistogram);
		view.drawn = () => this.drawn();
		new Navigate(view, null, {
			hover: (at) => this.pixel.show(at, at && view.values(...at)),
			click: (at) => {
				const values = view.values(...at);
				this.pixel.show(values ? at : null, values);
				this.pixel.pin(values ? at : null);
			},
			region: () => {},
			drawsRegion: () => false,
			isMovable: () => false
		});
		this.compose();
		this.watch();
	}
	tell = (message) => this.messages.add(message);
	showHistogram = () => this.histogram.update(() => this.view.statistics(), this.view.tone.exposure);
	compose() {
		const { view } = this;
		const panel = h("button", {
			title: "Show or hide the panel (N)",
			"aria-expanded": "true"
		}, "Panel");
		const setPanel = (hidden) => panel.setAttribute("aria-expanded", String(!hidden));
		const togglePanel = () => setPanel(document.body.classList.toggle("no-panel"));
		panel.addEventListener("click", togglePanel);
		const step = (shown, doc, by, ...codes) => ({
			shown,
			doc,
			group: "Picture",
			is: place(...codes),
			act: () => this.list.step(by)
		});
		const help = () => keys.toggle();
		const keys = new Keys([
			step("↑, Page up", "the picture before", -1, "ArrowUp", "PageUp"),
			step("↓, Page down", "the next picture", 1, "ArrowDown", "PageDown"),
			...pictureKeys({
				view,
				look: this.look,
				compare: this.compare,
				panel: togglePanel,
				help
			}),
			{
				shown: "Escape",
				doc: "unpin the pixel",
				group: "Picture",
				is: place("Escape"),
				act: () => this.pixel.pin(null)
			}
		], POINTER);
		const button = (text, title, act, label) => h("button", {
			title,
			"aria-label": label,
			onclick: act
		}, text);
		const toolbar = h("div", {
			class: "toolbar",
			role: "toolbar",
			"aria-label": "Picture"
		}, button("Fit", "Fit the picture into the window (F)", () => (view.placement.fit(), view.redraw())), button("1:1", "One pixel for each pixel (1)", () => (view.placement.actual(), view.redraw())), button("◂", "The picture before (↑)", () => this.list.step(-1), "Picture before"), button("▸", "The next picture (↓)", () => this.list.step(1), "Next picture"), h("span", { class: "gap" }), themeButton(this.showHistogram), button("?", "Keys and pointer (?)", help, "Keys and pointer"), panel);
		const drop = new Drop(this.tell, "Drop pictures, or folders of them", ({ added }) => void this.dropped(added ?? []));
		document.body.append(h("main", { class: "stage" }, h("h1", { class: "hidden" }, "Steradian"), this.canvas, this.numbers.element, this.compare.divider.element, this.compare.tag, toolbar, this.legend.element, this.messages.toast, drop.hint), this.status, h("aside", {
			class: "panel",
			"aria-label": "Panels"
		}, this.list.element, this.look.element, this.pixel.element, this.compare.element, this.histogram.element, this.messages.element), keys.help);
		setPanel(document.body.classList.toggle("no-panel", innerWidth < 720));
	}
	/** Looks for changed files, again and again. */
	async watch() {
		await this.refresh();
		setTimeout(() => void this.watch(), PAUSE);
	}
	/** Takes the list; what has changed is shown anew. */
	async refresh() {
		try {
			this.take(await fetchList());
			setText(this.lost, "");
		} catch {
			setText(this.lost, "no connection");
		}
		this.status.classList.toggle("lost", this.lost.textContent !== "");
	}
	take(listings) {
		const version = (id) => listings.find((l) => l.id === id)?.version;
		const b = this.otherId;
		const isOtherNew = b !== null && version(b) !== this.listings.find((l) => l.id === b)?.version;
		this.listings = listings;
		this.list.update(listings);
		setOptions(this.other, [{
			value: "",
			text: "none"
		}, ...listings.map(({ id, name }) => ({
			value: String(id),
			text: name
		}))]);
		this.other.value = b === null ? "" : String(b);
		const { asked } = this;
		if (!asked) {
			const first = listings.find(({ fault }) => fault === null) ?? listings[0];
			if (first) this.choose(first.id);
		} else if (version(asked.id) !== asked.version) this.choose(asked.id);
		if (isOtherNew) this.compare.changedElsewhere();
	}
	async dropped(ids) {
		await this.refresh();
		if (ids[0] !== void 0) this.choose(ids[0]);
	}
	choose(id) {
		this.asked = {
			id,
			version: this.listings.find((l) => l.id === id)?.version ?? 0
		};
		this.list.mark(id);
		this.show();
	}
	/** Fetches the layer of the picture that was asked for last, and shows it. */
	async show() {
		const { asked, view } = this;
		if (!asked) return;
		const turn = ++this.turn;
		try {
			let found = await fetchPicture(asked.id, view.layer);
			if (turn !== this.turn) return;
			if (!found) {
				const name = this.listings.find(({ id }) => id === asked.id)?.name ?? "";
				this.tell({
					severity: "note",
					text: `'${name}' has no layer '${view.layer}': its colours are shown`
				});
				view.layer = "picture";
				found = await fetchPicture(asked.id, view.layer);
				if (turn !== this.turn || !found) return;
			}
			this.takePicture(found);
		} catch (error) {
			if (turn !== this.turn) return;
			this.about = null;
			view.layers.keep([]);
			view.redraw();
			setText(this.facts, "no picture");
			this.pixel.refresh();
			const name = this.listings.find(({ id }) => id === asked.id)?.name ?? "";
			this.tell({
				severity: "error",
				text: `${name}: ${error instanceof Error ? error.message : String(error)}`
			});
			await this.refresh();
		}
	}
	takePicture({ head, tiles }) {
		const { view, first } = this;
		const { width, height, layer } = head;
		const longest = Math.max(width, height);
		if (longest > view.longest) throw new Error(`${longest} pixels are too many along an edge for this browser: ${view.longest}`);
		const isOther = this.about?.id !== head.id || this.about.version !== head.version;
		this.about = head;
		view.film = {
			width,
			height
		};
		for (const tile of tiles) view.tile(layer, tile);
		view.frame({
			crop: [
				0,
				0,
				width,
				height
			],
			lightGroups: [],
			width,
			height
		});
		this.look.update({
			choices: {
				tones: first.tones,
				layers: head.layers
			},
			scene: {
				name: "",
				path: null
			},
			exposure: first.exposure,
			tone: first.tone,
			layers: []
		});
		view.layers.keep([layer]);
		this.look.takeFrame();
		this.compare.changedElsewhere();
		this.showHistogram();
		if (isOther) {
			this.pixel.refresh();
			for (const text of head.notes) this.tell({
				severity: "note",
				text: `${head.name}: ${text}`
			});
		}
		document.title = `${head.name} – Steradian`;
		const text = `${head.name} · ${width} × ${height}${layer === "picture" ? "" : ` · ${layer}`}`;
		setText(this.facts, text);
		this.facts.title = text;
	}
	get otherId() {
		return this.other.value === "" ? null : Number(this.other.value);
	}
	/** B: another picture of the list, of the same size and with the shown layer. */
	source() {
		return {
			fetch: () => this.fetchOther(),
			flip: (tone, exposure) => fetchFlip(this.about.id, this.otherId, this.view.layer, tone, exposure),
			controls: (act) => {
				this.other.addEventListener("change", () => act(async () => {}));
				return [row("B", this.other, "The picture that the shown one, A, is compared with")];
			}
		};
	}
	async fetchOther() {
		const [id, a] = [this.otherId, this.about];
		if (id === null || !a) return null;
		const listing = this.listings.find((l) => l.id === id);
		const key = JSON.stringify([
			id,
			listing?.version,
			a.layer
		]);
		if (this.kept?.key !== key) {
			const found = await fetchPicture(id, a.layer);
			if (!found) throw new Error(`'${listing?.name}' has no layer '${a.layer}'`);
			const { name, width, height } = found.head;
			this.kept = {
				key,
				pieces: {
					head: {
						name,
						width,
						height,
						crop: null
					},
					tiles: found.tiles
				}
			};
		}
		const { head } = this.kept.pieces;
		if (head.width !== a.width || head.height !== a.height) {
			const size = (of) => `'${of.name}' has ${of.width} × ${of.height} pixels`;
			throw new Error(`${size(a)}, ${size(head)}: they are not compared`);
		}
		return this.kept.pieces;
	}
	drawn() {
		const { view } = this;
		this.numbers.draw();
		const ends = view.scale();
		this.legend.update(view.showsMap ? FLIP_SCALE : ends && falseScale(ends, 1, ""));
	}
};
async function start() {
	trackEditing();
	new Pictures(await fetchLook());
}
start().catch((error) => {
	const text = `The page cannot run: ${error instanceof Error ? error.message : String(error)}`;
	document.body.append(h("p", {
		class: "fatal",
		role: "alert"
	}, text));
});
