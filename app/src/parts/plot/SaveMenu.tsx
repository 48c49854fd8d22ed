// A plot to take away: PNG as it is seen, SVG for documents, CSV for other programs.
import { colour } from "../../shell/theme";
import type { PlotData, Range } from "./series";
import { csvOf } from "./series";
import { svgOf } from "./svg";

function save(content: Blob, name: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

interface SaveMenuProps {
  data: PlotData;
  range: Range;
  canvas: () => HTMLCanvasElement | undefined;
}

export function SaveMenu({ data, range, canvas }: SaveMenuProps) {
  const name = data.title.toLowerCase().replace(/[^a-z0-9]+/g, "-");
  const png = (): void => {
    const drawn = canvas();
    const sheet = document.createElement("canvas");
    if (!drawn) return;
    [sheet.width, sheet.height] = [drawn.width, drawn.height];
    const ink = sheet.getContext("2d");
    if (!ink) return;
    ink.fillStyle = colour("paper");
    ink.fillRect(0, 0, sheet.width, sheet.height);
    ink.drawImage(drawn, 0, 0);
    sheet.toBlob((blob) => blob && save(blob, `${name}.png`));
  };
  const kinds: [string, () => void][] = [
    ["PNG", png],
    ["SVG", () => save(new Blob([svgOf(data, range, colour)], { type: "image/svg+xml" }), `${name}.svg`)],
    ["CSV", () => save(new Blob([csvOf(data)], { type: "text/csv" }), `${name}.csv`)],
  ];
  return (
    <span class="save" role="group" aria-label={`Save ${data.title}`}>
      {kinds.map(([kind, act]) => (
        <button type="button" key={kind} onClick={act}>
          {kind}
        </button>
      ))}
    </span>
  );
}
