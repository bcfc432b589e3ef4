// Looks at pages of a report in a headless browser: no violation of the rules
// of axe-core (WCAG 2.2 A and AA, best practice), light and dark, wide and
// narrow; every table sorts by keyboard and downloads as CSV with as many
// fields in every line; without scripts there is no button.
//
//   npm install --no-save axe-core
//   node verify/tests/check_report.mjs reports/verify/index.html …
//
// CHROMIUM names the browser [default: chromium].
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

const require = createRequire(join(process.cwd(), "package.json"));
const axe = readFileSync(require.resolve("axe-core/axe.min.js"), "utf8").replaceAll("</script", "<\\/script");
const folder = mkdtempSync(join(tmpdir(), "report-"));

// Runs a function in the page and returns what it resolves to.
function inPage(html, library, work, options) {
  const tell = `(${work})().then((found) => {
    const text = JSON.stringify(found).replaceAll("&", "&amp;").replaceAll("<", "&lt;");
    document.documentElement.innerHTML = "<body><pre id=found>" + text + "</pre></body>";
  })`;
  const script = `<script>${library}</script><script>addEventListener("load", () => ${tell})</script>`;
  const page = join(folder, "page.html");
  writeFileSync(page, html.replace("</body>", () => script + "</body>"));
  const browser = process.env.CHROMIUM ?? "chromium";
  const flags = ["--headless", "--no-sandbox", "--disable-gpu", "--virtual-time-budget=60000", ...options];
  const dom = execFileSync(browser, [...flags, "--dump-dom", pathToFileURL(page).href], {
    maxBuffer: 1 << 28, stdio: ["ignore", "pipe", "ignore"], encoding: "utf8",
  });
  const found = dom.match(/<pre id="found">([\s\S]*?)<\/pre>/);
  if (!found) throw new Error("the page did not answer");
  return JSON.parse(found[1].replaceAll("&lt;", "<").replaceAll("&gt;", ">").replaceAll("&amp;", "&"));
}

const judge = `async () => (await axe.run(document, {
  resultTypes: ["violations"],
  runOnly: { type: "tag", values: ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"] },
})).violations.map((v) => v.id + " (" + v.nodes.length + "): " + v.help + ": " + v.nodes[0].html.slice(0, 200))`;

const use = `async () => {
  const said = [], files = [];
  URL.createObjectURL = (blob) => (files.push(blob), "blob:null/" + files.length);
  HTMLAnchorElement.prototype.click = function () { said.push(this.download); };
  document.querySelectorAll("details").forEach((fold) => { fold.open = true; });
  const wrong = [], tables = [...document.querySelectorAll("table")];
  for (const table of tables) {
    const name = table.dataset.file;
    for (const head of table.querySelectorAll("thead th")) {
      const button = head.querySelector("button");
      button.focus();
      if (document.activeElement !== button) wrong.push(name + ": no focus");
      for (const way of ["ascending", "descending"]) {
        button.click();
        if (head.getAttribute("aria-sort") !== way) wrong.push(name + ": not " + way);
      }
      const keys = [...table.tBodies[0].rows].map((row) => row.cells[head.cellIndex].dataset.key);
      const numbers = keys.map(Number).filter((n) => !isNaN(n));
      if (keys.every((key) => key && key !== "") && numbers.some((n, i) => i > 0 && n > numbers[i - 1])) {
        wrong.push(name + ": not sorted");
      }
    }
  }
  document.querySelectorAll(".tools button").forEach((button) => button.click());
  const texts = await Promise.all(files.map((blob) => blob.text()));
  texts.forEach((text, i) => {
    const fields = (line) => line.replace(/"([^"]|"")*"/g, "q").split(",").length;
    const lines = text.trimEnd().split("\\r\\n");
    if (new Set(lines.map(fields)).size !== 1) wrong.push(said[i] + ": lines differ in fields");
    if (lines.length !== 1 + tables[i].tBodies[0].rows.length) wrong.push(said[i] + ": rows are lost");
  });
  if (new Set(said).size !== tables.length) wrong.push(said.length + " files of " + tables.length + " tables");
  return wrong;
}`;

let failed = false;
try {
  for (const path of process.argv.slice(2)) {
    const html = readFileSync(path, "utf8");
    const silent = html.split("<script>")[0].includes("<button") ? ["a button without scripts"] : [];
    const looks = {
      "wide, light": ["--window-size=1280,900"],
      "narrow, light": ["--window-size=390,800"],
      "wide, dark": ["--window-size=1280,900", "--blink-settings=preferredColorScheme=0"],
    };
    const found = Object.entries(looks).map(([look, options]) => [look, inPage(html, axe, judge, options)]);
    found.push(["tables", inPage(html, "", use, [])], ["without scripts", silent]);
    for (const [what, wrong] of found) {
      console.log(`${path}, ${what}: ${wrong.length === 0 ? "sound" : wrong.length + " wrong"}`);
      wrong.forEach((line) => console.log("  " + line));
      failed ||= wrong.length > 0;
    }
  }
} finally {
  rmSync(folder, { recursive: true });
}
process.exitCode = failed || process.argv.length < 3 ? 1 : 0;
