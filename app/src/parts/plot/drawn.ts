// What stands on a page as SVG, words and pictures, as one SVG that needs no sheet of styles.
const NS = "http://www.w3.org/2000/svg";
const LOOKS = ["fill", "fill-opacity", "stroke", "stroke-width", "stroke-dasharray", "opacity", "font-size", "font-family", "font-weight", "color", "vector-effect"]; // prettier-ignore

/** A copy of a drawing in which every part says itself how it looks. */
function dressed(drawing: Element): Element {
  const copy = drawing.cloneNode(true) as Element;
  const all = [drawing, ...drawing.querySelectorAll("*")];
  [copy, ...copy.querySelectorAll("*")].forEach((one, i) => {
    const look = getComputedStyle(all[i] ?? drawing);
    for (const name of LOOKS) one.setAttribute(name, look.getPropertyValue(name));
    for (const name of ["class", "style"]) one.removeAttribute(name);
  });
  return copy;
}

export function drawnAs(root: Element, paper: string): [svg: string, width: number, height: number] {
  const from = root.getBoundingClientRect();
  const out = document.createElementNS(NS, "svg");
  const put = (one: Element, at: DOMRect, more: Record<string, string> = {}): Element => {
    const size = { x: at.x - from.x, y: at.y - from.y, width: at.width, height: at.height };
    for (const [name, value] of Object.entries({ ...size, ...more })) one.setAttribute(name, String(value));
    return out.appendChild(one);
  };
  out.setAttribute("viewBox", `0 0 ${from.width} ${from.height}`);
  put(document.createElementNS(NS, "rect"), from, { fill: paper });
  const walk = document.createTreeWalker(root, NodeFilter.SHOW_ELEMENT | NodeFilter.SHOW_TEXT);
  const range = document.createRange();
  for (let node: Node | null = root; node; node = walk.nextNode()) {
    if (root.contains(node.parentElement?.closest("svg") ?? null)) continue;
    if (node instanceof SVGSVGElement) put(dressed(node), node.getBoundingClientRect());
    else if (node instanceof HTMLCanvasElement)
      put(document.createElementNS(NS, "image"), node.getBoundingClientRect(), { href: node.toDataURL() });
    else if (node instanceof HTMLElement && node.tagName === "I") {
      const { borderStyle, borderTopColor: stroke, backgroundColor: fill } = getComputedStyle(node);
      const look: Record<string, string> = borderStyle === "none" ? { fill } : { fill: "none", stroke };
      put(document.createElementNS(NS, "rect"), node.getBoundingClientRect(), look);
    } else if (node instanceof Text && node.data.trim()) {
      range.selectNodeContents(node);
      const [at, look] = [range.getBoundingClientRect(), getComputedStyle(node.parentElement ?? root)];
      const words = document.createElementNS(NS, "text");
      words.textContent = node.data.replaceAll(" ", "\u00a0");
      put(words, at, { y: String(at.y - from.y + 0.78 * at.height), fill: look.color });
      for (const name of ["font-size", "font-family", "font-weight"])
        words.setAttribute(name, look.getPropertyValue(name));
    }
  }
  return [new XMLSerializer().serializeToString(out), from.width, from.height];
}
