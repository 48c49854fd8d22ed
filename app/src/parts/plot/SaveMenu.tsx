// A plot to take away: PNG as it is seen, SVG for documents, CSV for other programs.
import { save } from "../../shell/paper";
import { colour } from "../../shell/theme";

/** A picture on a sheet of our paper. */
export function sheetOf(drawn: CanvasImageSource, width: number, height: number): HTMLCanvasElement {
  const sheet = document.createElement("canvas");
  [sheet.width, sheet.height] = [width, height];
  const ink = sheet.getContext("2d");
  if (!ink) return sheet;
  ink.fillStyle = colour("paper");
  ink.fillRect(0, 0, width, height);
  ink.drawImage(drawn, 0, 0, width, height);
  return sheet;
}

interface SaveMenuProps {
  title: string;
  png: () => Promise<HTMLCanvasElement> | HTMLCanvasElement | null;
  svg: () => string;
  csv: () => string;
}

export function SaveMenu({ title, png, svg, csv }: SaveMenuProps) {
  const name = title.toLowerCase().replace(/[^a-z0-9]+/g, "-");
  const drawn = async (): Promise<void> => (await png())?.toBlob((blob) => blob && save(blob, `${name}.png`));
  const kinds: [string, () => void][] = [
    ["PNG", () => void drawn()],
    ["SVG", () => save(new Blob([svg()], { type: "image/svg+xml" }), `${name}.svg`)],
    ["CSV", () => save(new Blob([csv()], { type: "text/csv" }), `${name}.csv`)],
  ];
  return (
    <span class="save" role="group" aria-label={`Save ${title}`}>
      {kinds.map(([kind, act]) => (
        <button type="button" key={kind} onClick={act}>
          {kind}
        </button>
      ))}
    </span>
  );
}
