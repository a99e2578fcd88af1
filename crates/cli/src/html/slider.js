for (const figure of document.querySelectorAll(".slider")) {
  const [pair, range] = [figure.querySelector(".ab"), figure.querySelector("input")];
  const show = () => pair.style.setProperty("--at", range.value + "%");
  const follow = (event) => {
    const box = pair.getBoundingClientRect();
    range.value = (100 * (event.clientX - box.left)) / box.width;
    show();
  };
  range.addEventListener("input", show);
  pair.addEventListener("pointerdown", (event) => {
    event.preventDefault();
    pair.setPointerCapture(event.pointerId);
    follow(event);
  });
  pair.addEventListener("pointermove", (event) => event.buttons && follow(event));
  show();
}
