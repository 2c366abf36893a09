"use strict";
// The page of `seatsim explore`: sends what is set, and shows what comes back.
(() => {
  const main = document.querySelector("main"), find = name => document.getElementById(name);
  const [form, gains, fit, problem, saved] = ["controls", "gains", "fit", "problem", "saved"].map(find);
  let asked = 0, running = null, extra = {};

  function values() {
    const collect = inputs => Object.fromEntries([...inputs].map(input => [input.name, input.type === "range" ? Number(input.value) : input.value]));
    const found = collect(form.querySelectorAll(":scope > label [name]")), effects = {};
    if (gains.children.length) found.gains = collect(gains.querySelectorAll("input"));
    for (const effect of form.querySelectorAll(".effect")) {
      const box = effect.querySelector("input[type=checkbox]");
      if (box.checked) effects[box.name] = collect(effect.querySelectorAll("input[type=range]"));
    }
    return fit ? { ...found, effects } : found;
  }

  async function send(address, content) {
    const answer = await fetch(address, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(content) });
    const found = await answer.json();
    if (!answer.ok) throw new Error(found.error);
    return found;
  }

  const say = input => { input.parentElement.querySelector("output").textContent = Number(Number(input.value).toPrecision(4)); };

  function move(fitted) {
    for (const [name, values] of Object.entries(fitted)) {
      const { parentElement } = form.querySelector(`.effect input[name="${name}"]`).parentElement;
      for (const input of parentElement.querySelectorAll("input[type=range]")) { input.value = values[input.name]; say(input); }
    }
  }

  // One request at a time: what was moved meanwhile is sent when the answer is there.
  async function update() {
    asked += 1;
    if (running) return;
    main.classList.add("busy");
    while (running !== asked) {
      running = asked;
      try {
        const content = { ...values(), ...extra };
        extra = {};
        const found = await send("/view", content);
        find("answer").textContent = found.answer;
        find("tables").innerHTML = found.tables;
        if (!gains.children.length) gains.innerHTML = found.gains;
        move(found.fitted);
        await seatsimCharts[0].load(found.signals);
        problem.textContent = "";
      } catch (error) { problem.textContent = error.message; }
    }
    running = null;
    main.classList.remove("busy");
    main.dataset.shown = asked;
  }

  form.addEventListener("input", event => {
    const { target } = event;
    if (target.type === "range") say(target);
    if (target.name === "law" || target.name === "run") gains.replaceChildren();
    if (target.type === "checkbox") target.closest(".effect").querySelector(".parameters").hidden = !target.checked;
    if (target.id !== "name") update();
  });
  if (fit) fit.addEventListener("click", () => { extra = { fit: true }; update(); });
  form.addEventListener("submit", event => event.preventDefault());
  find("save").addEventListener("click", async () => {
    const answer = send("/save", { ...values(), name: find("name").value });
    saved.textContent = await answer.then(found => `saved as ${found.saved}`, error => error.message);
  });
})();
