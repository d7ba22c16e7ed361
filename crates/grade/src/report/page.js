"use strict";
const zoom = document.getElementById("zoom");
const pace = document.getElementById("pace");
const shownPace = document.getElementById("shown-pace");
const images = [...document.images];

function resize() {
  for (const image of images) {
    image.style.width = `${image.naturalWidth * zoom.value}px`;
    image.style.height = `${image.naturalHeight * zoom.value}px`;
  }
}
zoom.addEventListener("input", resize);
window.addEventListener("load", resize);
resize();

document.getElementById("lost").addEventListener("change", (event) => {
  document.body.classList.toggle("only-lost", event.target.checked);
});

function show(figure, second) {
  figure.querySelector("div").classList.toggle("second", second);
  figure.querySelector("span").textContent = second ? "wanted" : "yours";
}

// One clock for all, so that pictures flicker together.
let second = false;
let clock;
function start() {
  clearInterval(clock);
  shownPace.textContent = pace.value;
  clock = setInterval(() => {
    second = !second;
    for (const figure of document.querySelectorAll(".flicker.running")) show(figure, second);
  }, Number(pace.value));
}
pace.addEventListener("input", start);
start();

for (const figure of document.querySelectorAll(".flicker")) {
  const toggle = () => {
    const running = figure.classList.toggle("running");
    figure.querySelector("button").textContent = running ? "stop" : "flicker";
    if (!running) show(figure, false);
  };
  figure.querySelector("button").addEventListener("click", toggle);
  figure.querySelector("div").addEventListener("click", toggle);
}
