// The page on paper, and pages and plots as files that need no server.
export function save(content: Blob | string, name: string): void {
  const link = document.createElement("a");
  link.href = typeof content === "string" ? content : URL.createObjectURL(content);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

const framed = (): HTMLIFrameElement | null => document.querySelector("iframe.report");

/** A framed report prints itself, whole; of any other page what is shown. */
export function printPage(): void {
  const report = framed()?.contentWindow;
  if (report) report.postMessage("print", "*");
  else print();
}

document.addEventListener("keydown", (event) => {
  if (event.key !== "p" || !(event.ctrlKey || event.metaKey)) return;
  event.preventDefault();
  printPage();
});

/** One file of HTML: what is shown, for the stretch that is shown, plots as pictures, nothing that runs. */
export function savePage(): void {
  const name = `${document.title.replace(/[^A-Za-z0-9]+/g, "-")}.html`;
  const report = framed();
  if (report) return save(report.src, name);
  const copy = document.documentElement.cloneNode(true) as HTMLElement;
  const drawn = document.querySelectorAll("canvas");
  copy.querySelectorAll("canvas").forEach((sheet, i) => {
    const picture = document.createElement("img");
    picture.src = drawn[i]?.toDataURL() ?? "";
    picture.alt = sheet.closest("[aria-label]")?.getAttribute("aria-label") ?? "";
    picture.style.cssText = sheet.style.cssText;
    sheet.replaceWith(picture);
  });
  for (const gone of copy.querySelectorAll("script, link, .top, .tools, .save, .acts, .skip")) gone.remove();
  for (const link of copy.querySelectorAll("a"))
    link.href = new URL(link.getAttribute("href") ?? "", location.href).href;
  const style = document.createElement("style");
  style.textContent = [...document.styleSheets].flatMap((s) => [...s.cssRules].map((r) => r.cssText)).join("\n");
  copy.querySelector("head")?.append(style);
  save(new Blob(["<!doctype html>", copy.outerHTML], { type: "text/html" }), name);
}
