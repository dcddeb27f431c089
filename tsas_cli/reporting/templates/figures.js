"use strict";
// Plots of the page: values under the pointer, curves hidden by their legend, a part enlarged.
// Without this script they are the same pictures.
(() => {
const NEAR = 24; // units of a picture, from the pointer to a curve
const LEAST = 8; // of a part to enlarge
const STEPS = [1, 2, 2.5, 5, 10];

const make = (name, attributes) => {
  const it = document.createElementNS(document.querySelector("svg").namespaceURI, name);
  for (const [key, value] of Object.entries(attributes)) it.setAttribute(key, value);
  return it;
};
const pair = (text) => text.split(" ").map(Number);
// A curve, its bars and its points look alike: points have a fill too.
const look = ({style: {stroke, strokeDasharray, fill}}) =>
  stroke && stroke !== "none" ? [stroke, strokeDasharray].join() : `fill ${fill}`;
const coordinates = (path) => path.getAttribute("d").match(/-?\d+(\.\d+)?/g).map(Number);
const split = (label) => /^(.*) \[(.*)\]$/.exec(label)?.slice(1) ?? [label, ""];

const tip = document.createElement("div");
tip.className = "tip";
tip.hidden = true;
document.body.append(tip);

class Axes {
  constructor(group) {
    const [path] = group.getElementsByTagName("path");
    const ends = coordinates(path), across = ends.filter((_, k) => k % 2 === 0);
    const down = ends.filter((_, k) => k % 2);
    this.group = group;
    this.names = JSON.parse(group.dataset.names);
    // Along x, then along y: where the axis begins and ends in the picture, and the values there.
    this.box = [[Math.min(...across), Math.max(...across)], [Math.max(...down), Math.min(...down)]];
    this.whole = [pair(group.dataset.x), pair(group.dataset.y)];
    this.view = this.whole;
    this.parts = [...group.querySelectorAll(":scope > g")];
    this.clipped = this.parts.flatMap((part) => [...part.querySelectorAll("[clip-path][d]")])
      .filter((it) => !it.closest("[id*=tick_]"))
      .map((it) => ({it, drawn: it.getAttribute("d"), look: look(it), points: []}));
    for (const curve of this.clipped) {
      const at = coordinates(curve.it);
      for (let k = 0; k < at.length; k += 2) curve.points.push([at[k], at[k + 1]]);
    }
    this.curves = this.clipped.filter(({it, points}) => it.style.fill === "none" && points.length > 2);
    this.timed = this.curves.every(({points}) => points.every((p, k) => !k || p[0] >= points[k - 1][0]));
  }
  holds(point) {
    return this.box.every(([a, b], k) => (point[k] - a) * (point[k] - b) <= 0);
  }
  value(k, place, range = this.view) {
    const [a, b] = this.box[k], [low, high] = range[k];
    return low + (place - a) / (b - a) * (high - low);
  }
  place(k, value) {
    const [a, b] = this.box[k], [low, high] = this.view[k];
    return a + (value - low) / (high - low) * (b - a);
  }
  moved(point) {
    return point.map((place, k) => this.place(k, this.value(k, place, this.whole)));
  }
  text(k, value) {
    const [low, high] = this.view[k], digits = 3 - Math.floor(Math.log10(high - low));
    return value.toFixed(Math.min(Math.max(digits, 0), 9)).replace("-", "−");
  }
  show(view) {
    this.view = view;
    const whole = view === this.whole;
    for (const {it, drawn} of this.clipped) {
      const move = (_, x, y) => this.moved([+x, +y]).map((place) => place.toFixed(2)).join(" ");
      it.setAttribute("d", whole ? drawn : drawn.replace(/(-?[\d.]+) (-?[\d.]+)/g, move));
    }
    for (const it of this.group.querySelectorAll("[id*=tick_], :scope > g:has(> text)"))
      it.style.display = whole ? "" : "none";
    this.ticks?.remove();
    if (!whole) this.group.firstElementChild.after(this.ticks = this.ticked());
  }
  ticked() {
    const all = make("g", {}), [[left, right], [bottom, top]] = this.box;
    this.view.forEach(([low, high], k) => {
      const rough = (high - low) / 5, power = 10 ** Math.floor(Math.log10(rough));
      const step = power * STEPS.find((size) => size * power >= rough);
      const label = this.group.querySelector(`[id*=${"xy"[k]}tick_] text`);
      for (let n = Math.ceil(low / step); n * step <= high; n += 1) {
        const at = this.place(k, n * step), [x, y] = k ? [left - 7, at + 3.6] : [at, bottom + 14.2];
        const d = k ? `M${left} ${at}H${right}` : `M${at} ${bottom}V${top}`;
        all.append(make("path", {d, style: "stroke: var(--line); stroke-width: 0.7"}));
        if (!label) continue;
        const text = make("text", {x, y, style: label.getAttribute("style")});
        const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9) + (step / power === 2.5));
        text.textContent = (n * step).toFixed(digits).replace("-", "−");
        all.append(text);
      }
    });
    return all;
  }
}

class Plot {
  constructor(svg, axes) {
    this.svg = svg;
    this.axes = axes;
    this.names = {};
    this.hidden = new Set();
    this.marks = make("g", {"pointer-events": "none"});
    this.frame = make("rect", {class: "frame", width: 0, height: 0});
    svg.append(this.frame, this.marks);
    this.reset = this.button("Reset zoom", "reset", () => this.enlarge(axes[0], null));
    this.reset.textContent = "Reset zoom";
    this.reset.hidden = true;
    for (const legend of svg.querySelectorAll("[id*=legend_]")) this.keys(legend);
    svg.addEventListener("pointermove", (event) => this.over(this.at(event)));
    svg.addEventListener("pointerleave", () => this.over(null));
    svg.addEventListener("pointerdown", (event) => this.pressed(event));
    svg.addEventListener("dblclick", (event) => this.twice(this.at(event)));
  }
  button(name, kind, act) {
    const it = document.createElement("button");
    it.type = "button";
    it.className = kind;
    it.setAttribute("aria-label", name);
    it.addEventListener("click", act);
    this.svg.parentElement.append(it);
    return it;
  }
  keys(legend) {
    const {width, height} = this.svg.viewBox.baseVal;
    for (const {parentElement: entry} of legend.querySelectorAll("text")) {
      const sign = entry.previousElementSibling, drawn = sign?.querySelector("[style]");
      if (!drawn) continue;
      const [a, b] = [sign.getBBox(), entry.getBBox()], name = entry.textContent.trim();
      const key = this.button(name, "key", () => this.toggle(look(drawn), key, [sign, entry]));
      this.names[look(drawn)] = name;
      key.setAttribute("aria-pressed", "true");
      key.style.left = `${100 * a.x / width}%`;
      key.style.width = `${100 * (b.x + b.width - a.x) / width}%`;
      key.style.top = `${100 * (b.y + b.height / 2) / height}%`;
    }
  }
  toggle(which, key, entry) {
    const shown = this.hidden.delete(which) || !this.hidden.add(which);
    key.setAttribute("aria-pressed", shown);
    for (const it of entry) it.style.opacity = shown ? "" : 0.35;
    for (const part of this.axes.flatMap(({parts}) => parts))
      for (const it of part.querySelectorAll("[clip-path], [clip-path] use"))
        if (look(it) === which) it.style.display = shown ? "" : "none";
  }
  at(event) {
    const point = new DOMPoint(event.clientX, event.clientY);
    const {x, y} = point.matrixTransform(this.svg.getScreenCTM().inverse());
    const axes = this.axes.find((one) => one.holds([x, y]));
    return axes && {axes, point: [x, y], event};
  }
  beside(one, other) {
    return one === other || one.timed && other.timed && one.whole[0].join() === other.whole[0].join();
  }
  nearest({axes, point}, curve) {
    let best = {far: Infinity};
    curve.points.forEach((it, index) => {
      const [x, y] = axes.moved(it), far = Math.hypot(x - point[0], axes.timed ? 0 : y - point[1]);
      if (far < best.far) best = {curve, index, far};
    });
    return best;
  }
  over(place) {
    this.marks.replaceChildren();
    tip.hidden = true;
    const bare = !Object.keys(this.names).length; // without a legend every curve counts
    const visible = (one) => one.curves.filter((curve) => (bare || curve.look in this.names) && !this.hidden.has(curve.look));
    const found = place ? visible(place.axes).map((curve) => this.nearest(place, curve)) : [];
    const best = found.reduce((a, b) => (b.far < a.far ? b : a), {far: NEAR});
    if (!best.curve) return;
    const rows = [];
    for (const axes of [place.axes, ...this.axes.filter((one) => one !== place.axes)]) {
      // The same sample where curves have as many points, else the nearest over the same axis.
      const same = visible(axes).filter(({points}) => points.length === best.curve.points.length);
      const rest = visible(axes).filter((curve) => !same.includes(curve));
      const own = this.beside(axes, place.axes) ? rest.map((curve) => this.nearest({...place, axes}, curve)) : [];
      const all = [...same.map((curve) => ({curve, index: best.index})), ...own];
      const lead = same.includes(best.curve) ? best.curve : all[0]?.curve;
      all.forEach(({curve, index}) => {
        const point = curve.points[index], [x, y] = axes.moved(point);
        const below = this.axes.find((one) => one.names[0] && this.beside(one, axes));
        const [first, unit] = split(below?.names[0] ?? ""), [second, other] = split(axes.names[1]);
        if (curve === lead) {
          const time = axes.text(0, axes.value(0, point[0], axes.whole));
          rows.push(["", `${first} ${time} ${unit}`, second]);
        }
        const value = axes.text(1, axes.value(1, point[1], axes.whole));
        rows.push([curve.it.style.stroke, this.names[curve.look] ?? "", `${value} ${other}`]);
        if (axes.holds([x, y]))
          this.marks.append(make("circle", {cx: x, cy: y, r: 3, class: "mark", style: `fill: ${curve.it.style.stroke}`}));
      });
    }
    tip.replaceChildren(...rows.flatMap(([colour, name, value]) => {
      const cells = [document.createElement("i"), document.createElement("span"), document.createElement("b")];
      cells[0].style.background = colour;
      cells[1].textContent = name;
      cells[2].textContent = value;
      return cells;
    }));
    tip.hidden = false;
    const {clientX, clientY} = place.event, {width, height} = tip.getBoundingClientRect();
    tip.style.left = `${Math.max(4, clientX + 18 + width > innerWidth ? clientX - width - 18 : clientX + 18)}px`;
    tip.style.top = `${Math.max(4, Math.min(clientY + 14, innerHeight - height - 4))}px`;
  }
  pressed(event) {
    const start = event.pointerType === "mouse" && event.button === 0 && this.at(event);
    if (!start) return;
    event.preventDefault();
    const corners = (end) => [0, 1].map((k) => [start.point[k], end.point[k]].sort((a, b) => a - b));
    const drag = (move) => {
      const end = this.at(move);
      if (end?.axes !== start.axes) return;
      const [[left, right], [top, bottom]] = corners(end);
      const size = {x: left, y: top, width: right - left, height: bottom - top};
      for (const [name, value] of Object.entries(size)) this.frame.setAttribute(name, value);
    };
    const drop = () => {
      removeEventListener("pointermove", drag);
      const [x, y, width, height] = ["x", "y", "width", "height"].map((name) => +this.frame.getAttribute(name));
      this.frame.setAttribute("width", 0);
      this.frame.setAttribute("height", 0);
      const part = [[x, x + width], [y + height, y]];
      if (width > LEAST && height > LEAST)
        this.enlarge(start.axes, part.map((ends, k) => ends.map((end) => start.axes.value(k, end))));
    };
    addEventListener("pointermove", drag);
    addEventListener("pointerup", drop, {once: true});
  }
  twice(place) {
    if (!place) return;
    const {axes, point} = place;
    this.enlarge(axes, axes.view.map(([low, high], k) => {
      const middle = axes.value(k, point[k]), reach = (high - low) / 5;
      return [middle - reach, middle + reach];
    }));
  }
  enlarge(axes, view) {
    for (const one of this.axes) {
      if (!view) one.show(one.whole);
      else if (one === axes) one.show(view);
      else if (this.beside(one, axes)) one.show([view[0], one.view[1]]);
    }
    this.reset.hidden = !view;
    this.over(null);
  }
}

const seen = new IntersectionObserver((entries) => {
  for (const {isIntersecting, target} of entries) {
    if (!isIntersecting) continue;
    seen.unobserve(target);
    const axes = [...target.querySelectorAll("[data-x]")].map((group) => new Axes(group));
    new Plot(target, axes);
  }
});
for (const svg of document.querySelectorAll("figure svg:has([data-x])")) seen.observe(svg);

// A link to a section that is folded opens it.
const unfold = () => {
  const fold = document.getElementById(location.hash.slice(1))?.querySelector(":scope > details");
  if (fold) fold.open = true;
};
addEventListener("hashchange", unfold);
unfold();

// What is folded is printed too; where the style sheet does not unfold it, this does.
let folded = [];
addEventListener("beforeprint", () => {
  folded = [...document.querySelectorAll("details:not([open])")];
  for (const it of folded) it.open = true;
});
addEventListener("afterprint", () => folded.forEach((it) => { it.open = false; }));
})();
