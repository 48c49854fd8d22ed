// A plot to take away: PNG as it is seen, SVG for documents, CSV for other programs.
import { save } from "../../shell/paper";
import { colour } from "../../shell/theme";
import { drawnAs } from "./drawn";

/** A picture on a sheet of our paper. */
export function sheetOf(drawn: HTMLCanvasElement | HTMLImageElement, times = 1): HTMLCanvasElement {
  const sheet = document.createElement("canvas");
  const [width, height] = ([sheet.width, sheet.height] = [times * drawn.width, times * drawn.height]);
  const ink = sheet.getContext("2d");
  if (!ink) return sheet;
  ink.fillStyle = colour("paper");
  ink.fillRect(0, 0, width, height);
  ink.drawImage(drawn, 0, 0, width, height);
  return sheet;
}

/** Drawings are told the button that was pressed. */
type Sheet = (from: Element) => Promise<HTMLCanvasElement> | HTMLCanvasElement | null;
type SaveMenuProps = { title: string; png: Sheet; svg: (from: Element) => string; csv: () => string };

const near = (from: Element): ReturnType<typeof drawnAs> =>
  drawnAs(from.closest("figure, .card")?.querySelector(".drawn") ?? from, colour("paper"));

async function pictureNear(from: Element): Promise<HTMLCanvasElement> {
  const [svg] = near(from);
  const image = new Image();
  image.src = `data:image/svg+xml,${encodeURIComponent(svg)}`;
  await image.decode();
  return sheetOf(image, 2);
}

/** Of what is marked as drawn in the same figure or card. */
export const SaveDrawn = (of: Pick<SaveMenuProps, "title" | "csv">) => (
  <SaveMenu {...of} png={pictureNear} svg={(from) => near(from)[0]} />
);

export function SaveMenu({ title, png, svg, csv }: SaveMenuProps) {
  const name = title.toLowerCase().replace(/[^a-z0-9]+/g, "-");
  const drawn = async (from: Element): Promise<void> =>
    (await png(from))?.toBlob((blob) => blob && save(blob, `${name}.png`));
  const kinds: [string, (from: Element) => void][] = [
    ["PNG", (from) => void drawn(from)],
    ["SVG", (from) => save(new Blob([svg(from)], { type: "image/svg+xml" }), `${name}.svg`)],
    ["CSV", () => save(new Blob([csv()], { type: "text/csv" }), `${name}.csv`)],
  ];
  return (
    <span class="save" role="group" aria-label={`Save ${title}`}>
      {kinds.map(([kind, act]) => (
        <button type="button" key={kind} onClick={(event) => act(event.currentTarget)}>
          {kind}
        </button>
      ))}
    </span>
  );
}
