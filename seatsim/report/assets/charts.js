"use strict";
// Draws the groups of linked pictures of a page with uPlot. Everything it draws stands on the page as packed numbers.
(() => {
  const WIDE = { 8: 3.4, 9: 2.4 }, GAP = -32768, HEIGHT = 240, PAPER_WIDTH = 680;
  const INCREMENTS = Array.from({ length: 25 }, (_, k) => [1, 2, 5].map(digit => Number(`${digit}e${k - 12}`))).flat();
  const paper = matchMedia("print"), dark = matchMedia("(prefers-color-scheme: dark)");
  const probe = document.body.appendChild(document.createElement("i"));
  const colour = name => { probe.style.color = `var(${name})`; return getComputedStyle(probe).color; };

  // Differences of 16-bit integers, low bytes before high ones, deflated, in base 64.
  async function unpack(line) {
    if (!line) return null;
    const packed = Uint8Array.from(atob(line.bits), letter => letter.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
    const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
    const count = bytes.length / 2, values = new Array(count);
    for (let k = 0, whole = 0; k < count; k++) {
      whole = (whole + (bytes[k] | (bytes[count + k] << 8))) << 16 >> 16;
      values[k] = whole === GAP ? null : line.at + line.step * whole;
    }
    return values;
  }

  // A little room above and below; a line that never moves stands in the middle.
  function roomAround(low, high) {
    const room = 0.06 * (high - low) || 0.1 * Math.abs(low) || 1;
    return low == null ? [0, 1] : [low - room, high + room];
  }

  const show = (value, digits = 3) => value == null ? "–" : String(Number(value.toPrecision(digits))).replace("-", "−");

  function download(name, address) {
    Object.assign(document.createElement("a"), { href: address, download: name }).click();
  }

  class Group {
    constructor(element) {
      const find = what => [...element.querySelectorAll(what)];
      this.element = element;
      [this.boxes, this.readouts, this.titles, this.switches] = [".plot", ".readout", "figure h3", ".switch input"].map(find);
      this.select = element.querySelector("select.run");
      this.plots = [];
      this.load(JSON.parse(element.querySelector("script").textContent));
      if (this.select) this.select.addEventListener("change", () => this.draw());
      this.switches.forEach((box, k) => box.addEventListener("change", () => this.plots.forEach(plot => plot.setSeries(k + 1, { show: box.checked }))));
      find(".buttons button").forEach(button => button.addEventListener("click", () => this.act(button.value)));
      element.querySelector("form").addEventListener("submit", event => event.preventDefault());
      this.boxes.forEach((box, k) => box.addEventListener("keydown", event => this.step(event, k)));
    }

    async load(data) {
      const values = await Promise.all(data.panels.map(panel => Promise.all(panel.runs.map(lines => Promise.all(lines.map(unpack))))));
      Object.assign(this, { data, values });
      this.draw();
    }

    draw() {
      if (!this.data) return;
      this.plots.forEach(plot => plot.destroy());
      const run = this.select ? Number(this.select.value) : 0, place = this.data.runs[run];
      const lines = this.values.map(panel => panel[run]);
      const length = Math.max(0, ...lines.flat().map(line => line ? line.length : 0));
      const x = Array.from({ length }, (_, k) => place.first + k * place.step);
      this.whole = [x[0], x[x.length - 1]];
      this.plots = this.boxes.map((box, k) => this.plot(box, k, x, lines[k].map(line => line || new Array(length).fill(null))));
    }

    get width() { return paper.matches ? PAPER_WIDTH : Math.max(200, this.boxes[0].clientWidth); }

    plot(box, number, x, lines) {
      const axis = { stroke: colour("--ink"), grid: { stroke: colour("--line"), width: 1 }, ticks: { show: false }, font: "13px system-ui, sans-serif", incrs: INCREMENTS,
        values: (plot, marks) => marks.map(mark => mark == null ? "" : show(mark, 6)) };
      const options = {
        width: this.width, height: HEIGHT, legend: { show: false },
        cursor: { sync: { key: this.element.id }, drag: { x: true, y: false, setScale: false }, y: false },
        scales: { x: { time: false, range: (plot, low, high) => [low, high] }, y: { range: (plot, low, high) => roomAround(low, high) } },
        axes: [{ ...axis, size: 30, gap: 4, space: 40, label: "time [s]", labelSize: 18, labelGap: 0, labelFont: axis.font }, { ...axis, size: 58, space: 24 }],
        series: [{}, ...this.data.lines.map((line, k) => ({
          label: line.name, stroke: colour(`--c${line.look}`), ...(WIDE[line.look] ? { width: WIDE[line.look], alpha: 0.55 } : { width: 1.4, alpha: line.opacity, dash: [[], [7, 3], [9, 3, 2, 3]][line.look % 3] }),
          points: { show: false }, spanGaps: false, show: this.switches[k] ? this.switches[k].checked : true,
        }))],
        hooks: {
          setCursor: [plot => this.read(plot, number)],
          setSelect: [plot => {
            if (plot.select.width < 3) return;
            this.zoom(plot.posToVal(plot.select.left, "x"), plot.posToVal(plot.select.left + plot.select.width, "x"));
            plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
          }],
          ready: [plot => plot.over.addEventListener("dblclick", () => this.zoom(...this.whole))],
        },
      };
      const empty = lines.every(line => line.every(value => value == null));
      this.readouts[number].textContent = empty ? "Nothing to draw: this run does not hold the channel." : "";
      box.dataset.drawn = empty ? "empty" : "yes";
      return new uPlot(options, [x, ...lines], box);
    }

    read(plot, number) {
      const row = plot.cursor.idx, { lines, panels } = this.data;
      const values = lines.map((line, k) => plot.series[k + 1].show ? `${line.name} ${show(plot.data[k + 1][row])}` : "").filter(text => text);
      this.readouts[number].textContent = row == null ? "" : `time ${show(plot.data[0][row])} s: ${values.join(" · ")} ${panels[number].unit}`;
    }

    zoom(low, high) {
      const from = Math.max(low, this.whole[0]), to = Math.min(high, this.whole[1]);
      if (to > from) this.plots.forEach(plot => plot.setScale("x", { min: from, max: to }));
    }

    act(what) {
      const { min: low, max: high } = this.plots[0].scales.x, size = high - low, [first, last] = this.whole;
      const left = Math.min(size / 4, low - first), right = Math.min(size / 4, last - high);
      const views = { in: [low + size / 4, high - size / 4], out: [low - size / 2, high + size / 2], all: this.whole,
        left: [low - left, high - left], right: [low + right, high + right] };
      if (what === "png") this.savePicture();
      else if (what === "csv") this.saveNumbers(low, high);
      else this.zoom(...views[what]);
    }

    // The pictures below each other, with their titles, on paper of the page's colour.
    savePicture() {
      const images = this.plots.map(plot => plot.ctx.canvas), { width, height } = images[0], line = 30 * devicePixelRatio;
      const sheet = Object.assign(document.createElement("canvas"), { width, height: (height + line) * images.length });
      const brush = Object.assign(sheet.getContext("2d"), { fillStyle: colour("--paper") });
      brush.fillRect(0, 0, sheet.width, sheet.height);
      Object.assign(brush, { fillStyle: colour("--ink"), font: `${line / 2}px system-ui, sans-serif` });
      images.forEach((image, k) => {
        brush.fillText(this.titles[k].textContent, line / 4, k * (height + line) + 0.7 * line);
        brush.drawImage(image, 0, k * (height + line) + line);
      });
      download("signals.png", sheet.toDataURL());
    }

    saveNumbers(low, high) {
      const { lines } = this.data, x = this.plots[0].data[0], shown = lines.map((_, k) => k).filter(k => this.plots[0].series[k + 1].show);
      const quote = text => `"${text.replaceAll('"', '""')}"`, round = value => value == null ? "" : Number(value.toPrecision(7));
      const head = ["time [s]", ...this.titles.flatMap(title => shown.map(k => `${title.textContent}, ${lines[k].name}`))].map(quote);
      const rows = x.flatMap((place, row) => place < low || place > high ? [] : [[place, ...this.plots.flatMap(plot => shown.map(k => plot.data[k + 1][row]))].map(round)]);
      download("signals.csv", URL.createObjectURL(new Blob([[head, ...rows].map(row => row.join(",")).join("\n") + "\n"], { type: "text/csv" })));
    }

    step(event, number) {
      const plot = this.plots[number], sign = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (!sign) return;
      event.preventDefault();
      const { min, max } = plot.scales.x;
      const now = plot.cursor.left >= 0 ? plot.cursor.left : plot.valToPos((min + max) / 2, "x");
      const left = Math.min(plot.over.clientWidth, Math.max(0, now + sign * (event.shiftKey ? 20 : 2)));
      this.plots.forEach(each => each.setCursor({ left, top: 10 }, true, false));
    }
  }

  const charts = window.seatsimCharts = [...document.querySelectorAll(".signals")].map(element => new Group(element));
  [dark, paper].forEach(query => query.addEventListener("change", () => charts.forEach(chart => chart.draw())));
  addEventListener("resize", () => charts.forEach(chart => chart.plots.forEach(plot => plot.setSize({ width: chart.width, height: HEIGHT }))));
})();
