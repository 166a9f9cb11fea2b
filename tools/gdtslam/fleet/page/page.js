"use strict";
// Rows: name, folder, run, picture, overview, scans, doubtful, path_m, duration_s, width_m, height_m, cpu_s.
const rows = JSON.parse(document.getElementById("data").textContent);
const kPerPage = 60;
const find = document.getElementById("find");
const order = document.getElementById("order");
const cards = document.getElementById("cards");
const pages = document.getElementById("pages");
let page = 0;
let chosen = [];

const keys = {
  path: (row) => row[7],
  area: (row) => row[9] * row[10],
  doubtful: (row) => row[6] / Math.max(1, row[5]),
  cpu: (row) => row[11],
};

function element(name, text, className) {
  const made = document.createElement(name);
  if (text) made.textContent = text;
  if (className) made.className = className;
  return made;
}

function link(text, target) {
  const made = element("a", text);
  made.href = target;
  return made;
}

function whole(number) {
  return Math.round(number).toLocaleString("en");
}

function duration(seconds) {
  if (seconds < 90) return `${Math.round(seconds)} s`;
  const minutes = Math.round(seconds / 60);
  return minutes < 90 ? `${minutes} min` : `${Math.floor(minutes / 60)}:${String(minutes % 60).padStart(2, "0")} h`;
}

function card([name, folder, run, picture, overview, scans, doubtful, path, log, width, height, cpu]) {
  const made = element("article", "", "card");
  const view = link("", overview || run + "/");
  view.className = "picture";
  if (picture) {
    const image = element("img");
    image.loading = "lazy";
    image.width = 320;
    image.height = 180;
    image.alt = `Map of ${name}`;
    image.src = picture;
    view.append(image);
  } else {
    view.textContent = "no picture";
  }
  const title = element("h3", name);
  if (folder) title.prepend(element("span", folder, "folder"));
  made.append(view, title);
  made.append(element("p", `${whole(path)} m in ${duration(log)}, ${whole(scans)} scans`));
  made.append(element("p", `${whole(width)} × ${whole(height)} m, ${cpu.toFixed(1)} s of CPU`));
  if (doubtful > 0) made.append(element("p", `${whole(doubtful)} doubtful scans`, "doubt"));
  const links = element("p", "", "links");
  if (overview) links.append(link("overview", overview));
  links.append(link("report", run + "/report.json"), link("folder", run + "/"));
  made.append(links);
  return made;
}

function show() {
  const last = Math.max(0, Math.ceil(chosen.length / kPerPage) - 1);
  page = Math.min(Math.max(page, 0), last);
  cards.replaceChildren(...chosen.slice(page * kPerPage, (page + 1) * kPerPage).map(card));
  document.getElementById("shown").textContent =
    chosen.length === rows.length ? whole(rows.length) : `${whole(chosen.length)} of ${whole(rows.length)}`;
  pages.replaceChildren();
  if (last === 0) return;
  const turn = (text, by) => {
    const button = element("button", text);
    button.type = "button";
    button.disabled = page + by < 0 || page + by > last;
    button.addEventListener("click", () => {
      page += by;
      show();
      document.getElementById("maps").scrollIntoView();
    });
    return button;
  };
  pages.append(turn("Previous", -1), element("span", `page ${page + 1} of ${last + 1}`, "quiet"), turn("Next", 1));
}

function choose() {
  const words = find.value.toLowerCase().split(/\s+/).filter(Boolean);
  chosen = rows.filter((row) => words.every((word) => `${row[1]}/${row[0]} ${row[2]}`.toLowerCase().includes(word)));
  const key = keys[order.value];
  if (key) chosen.sort((a, b) => key(b) - key(a));
  page = 0;
  show();
}

find.addEventListener("input", choose);
order.addEventListener("change", choose);
choose();
