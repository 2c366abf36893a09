"use strict";
// The page of `seatsim explore`: sends what is set, and shows what comes back.
(() => {
  const form = document.getElementById("controls"), main = document.querySelector("main");
  const problem = document.getElementById("problem"), saved = document.getElementById("saved");
  let asked = 0, running = null;

  const read = input => input.type === "range" ? Number(input.value) : input.value;

  function values() {
    const found = {}, effects = {};
    for (const input of form.querySelectorAll(":scope > label [name]")) found[input.name] = read(input);
    for (const effect of form.querySelectorAll(".effect")) {
      const box = effect.querySelector("input[type=checkbox]");
      if (box.checked) effects[box.name] = Object.fromEntries([...effect.querySelectorAll("input[type=range]")].map(input => [input.name, read(input)]));
    }
    return form.querySelector("fieldset") ? { ...found, effects } : found;
  }

  async function send(address, content) {
    const answer = await fetch(address, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(content) });
    const found = await answer.json();
    if (!answer.ok) throw new Error(found.error);
    return found;
  }

  // One request at a time: what was moved meanwhile is sent when the answer is there.
  async function update() {
    asked += 1;
    if (running) return;
    main.classList.add("busy");
    while (running !== asked) {
      running = asked;
      try {
        const found = await send("/view", values());
        document.getElementById("answer").textContent = found.answer;
        document.getElementById("tables").innerHTML = found.tables;
        seatsimCharts[0].load(found.signals);
        problem.textContent = "";
      } catch (error) { problem.textContent = error.message; }
    }
    running = null;
    main.classList.remove("busy");
    main.dataset.shown = asked;
  }

  form.addEventListener("input", event => {
    const { target } = event;
    if (target.type === "range") target.parentElement.querySelector("output").textContent = Number(Number(target.value).toPrecision(4));
    if (target.type === "checkbox") target.closest(".effect").querySelector(".parameters").hidden = !target.checked;
    if (target.id !== "name") update();
  });
  form.addEventListener("submit", event => event.preventDefault());
  document.getElementById("save").addEventListener("click", async () => {
    try {
      const found = await send("/save", { ...values(), name: document.getElementById("name").value });
      saved.textContent = `saved as ${found.saved}`;
    } catch (error) { saved.textContent = error.message; }
  });
})();
