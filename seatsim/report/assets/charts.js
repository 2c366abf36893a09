"use strict";
// Draws the groups of linked pictures of a page with uPlot. Everything it draws stands on the page as packed numbers.
(() => {
  const MEASURED = 8;
  const HEIGHT = 240, PAPER_WIDTH = 680;
  const charts = [];
  const paper = matchMedia("print"), dark = matchMedia("(prefers-color-scheme: dark)");
  const probe = document.body.appendChild(document.createElement("i"));
  const colour = name => { probe.style.color = `var(${name})`; return getComputedStyle(probe).color; };

  function unpack(line) {
    if (!line) return null;
    const bytes = Uint8Array.from(atob(line.bits), letter => letter.charCodeAt(0));
    const view = new DataView(bytes.buffer), values = new Array(bytes.length / 2);
    for (let k = 0; k < values.length; k++) {
      const whole = view.getInt16(2 * k, true);
      values[k] = whole === -32768 ? null : line.at + line.step * whole;
    }
    return values;
  }

  // A little room above and below; a line that never moves stands in the middle.
  function roomAround(low, high) {
    if (low == null || high == null) return [0, 1];
    const room = 0.06 * (high - low) || 0.1 * Math.abs(low) || 1;
    return [low - room, high + room];
  }

  function show(value) {
    if (value == null) return "–";
    const size = Math.abs(value);
    const text = size >= 1e7 || (size > 0 && size < 1e-5) ? value.toExponential(2) : value.toPrecision(3);
    return (text.includes("e") && size >= 1 && size < 1e7 ? String(Math.round(value)) : text).replace("-", "−");
  }

  class Group {
    constructor(element) {
      this.element = element;
      this.boxes = [...element.querySelectorAll(".plot")];
      this.readouts = [...element.querySelectorAll(".readout")];
      this.select = element.querySelector("select.run");
      this.switches = [...element.querySelectorAll(".switch input")];
      this.plots = [];
      this.load(JSON.parse(element.querySelector("script").textContent));
      this.listen();
    }

    load(data) {
      this.data = data;
      this.draw();
    }

    get run() { return this.select ? Number(this.select.value) : 0; }

    places() {
      const x = this.data.runs[this.run];
      const length = Math.max(0, ...this.lines(0, true).map(line => line.length));
      return Array.from({ length }, (_, k) => x.first + k * x.step);
    }

    lines(panel, known) {
      const found = this.data.panels[panel].runs[this.run].map(unpack);
      return known ? found.filter(line => line) : found;
    }

    draw() {
      this.plots.forEach(plot => plot.destroy());
      const x = this.places();
      this.whole = [x[0], x[x.length - 1]];
      this.plots = this.boxes.map((box, k) => this.plot(box, k, x));
    }

    plot(box, number, x) {
      const { data } = this, panel = data.panels[number], group = this;
      const lines = this.lines(number).map(line => line || new Array(x.length).fill(null));
      const axis = { stroke: colour("--ink"), grid: { stroke: colour("--line"), width: 1 }, ticks: { show: false },
        font: "13px system-ui, sans-serif", values: (plot, marks) => marks.map(mark => mark == null ? "" : String(Number(mark.toPrecision(6))).replace("-", "−")) };
      const options = {
        width: paper.matches ? PAPER_WIDTH : Math.max(200, box.clientWidth), height: HEIGHT,
        legend: { show: false },
        cursor: { sync: { key: this.element.id }, drag: { x: true, y: false, setScale: false }, y: false },
        scales: { x: { time: false, range: (plot, low, high) => [low, high] }, y: { range: (plot, low, high) => roomAround(low, high) } },
        axes: [
          { ...axis, size: 30, gap: 4, label: "time [s]", labelSize: 18, labelGap: 0, labelFont: "13px system-ui, sans-serif" },
          { ...axis, size: 58 },
        ],
        series: [{}, ...data.lines.map((line, k) => ({
          label: line.name, stroke: colour(`--c${line.look}`), ...(line.look === MEASURED ? { width: 3.4, alpha: 0.55 } : { width: 1.4, dash: line.look % 2 ? [7, 3] : [] }),
          points: { show: false }, spanGaps: false, show: this.switches[k] ? this.switches[k].checked : true,
        }))],
        hooks: {
          setCursor: [plot => group.read(plot, number)],
          setSelect: [plot => {
            if (plot.select.width < 3) return;
            group.zoom(plot.posToVal(plot.select.left, "x"), plot.posToVal(plot.select.left + plot.select.width, "x"));
            plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
          }],
          ready: [plot => plot.over.addEventListener("dblclick", () => group.zoom(...group.whole))],
        },
      };
      const made = new uPlot(options, [x, ...lines], box);
      const empty = lines.every(line => line.every(value => value == null));
      this.readouts[number].textContent = empty ? "Nothing to draw: this run does not hold the channel." : "";
      box.dataset.drawn = empty ? "empty" : "yes";
      return made;
    }

    read(plot, number) {
      const row = plot.cursor.idx, { data } = this;
      if (row == null) { this.readouts[number].textContent = ""; return; }
      const values = data.lines.map((line, k) => plot.series[k + 1].show ? `${line.name} ${show(plot.data[k + 1][row])}` : "");
      const place = `time ${show(plot.data[0][row])} s`;
      this.readouts[number].textContent = `${place}: ${values.filter(text => text).join(" · ")} ${data.panels[number].unit}`;
    }

    zoom(low, high) {
      const from = Math.max(low, this.whole[0]), to = Math.min(high, this.whole[1]);
      if (to > from) this.plots.forEach(plot => plot.setScale("x", { min: from, max: to }));
    }

    move(what) {
      const { min: low, max: high } = this.plots[0].scales.x, size = high - low, [first, last] = this.whole;
      const shift = { left: -Math.min(size / 4, low - first), right: Math.min(size / 4, last - high) }[what];
      if (what === "all") this.zoom(...this.whole);
      else if (shift !== undefined) this.zoom(low + shift, high + shift);
      else { const grow = what === "in" ? -size / 4 : size / 2; this.zoom(low - grow, high + grow); }
    }

    listen() {
      if (this.select) this.select.addEventListener("change", () => this.draw());
      this.switches.forEach((box, k) => box.addEventListener("change", () => this.plots.forEach(plot => plot.setSeries(k + 1, { show: box.checked }))));
      this.element.querySelectorAll(".buttons button").forEach(button => button.addEventListener("click", () => this.move(button.value)));
      this.element.querySelector("form").addEventListener("submit", event => event.preventDefault());
      this.boxes.forEach((box, k) => box.addEventListener("keydown", event => this.step(event, k)));
    }

    step(event, number) {
      const plot = this.plots[number], sign = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (!sign) return;
      event.preventDefault();
      const { min, max } = plot.scales.x, width = plot.over.clientWidth;
      const now = plot.cursor.left >= 0 ? plot.cursor.left : plot.valToPos((min + max) / 2, "x");
      const left = Math.min(width, Math.max(0, now + sign * (event.shiftKey ? 20 : 2)));
      this.plots.forEach(each => each.setCursor({ left, top: 10 }, true, false));
    }

    fit() {
      this.boxes.forEach((box, k) => {
        const width = paper.matches ? PAPER_WIDTH : Math.max(200, box.clientWidth);
        if (this.plots[k] && this.plots[k].width !== width) this.plots[k].setSize({ width, height: HEIGHT });
      });
    }
  }

  const start = () => document.querySelectorAll(".signals").forEach(element => charts.push(new Group(element)));
  const redraw = () => charts.forEach(chart => chart.draw());
  start();
  dark.addEventListener("change", redraw);
  paper.addEventListener("change", redraw);
  addEventListener("resize", () => charts.forEach(chart => chart.fit()));
  window.seatsimCharts = charts;
})();
