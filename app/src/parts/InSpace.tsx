// A structure to turn: the report's widget on a page.
import { useEffect, useLayoutEffect, useRef, useState } from "preact/hooks";
import { show, type View } from "../../../src/jackettwin/report/templates/view.js";
import "../../../src/jackettwin/report/templates/view.css";
import type { Schemas } from "../api/client";
import { asked, keep, place, useStrange } from "../shell/place";
import { theme } from "../shell/theme";

/** Pictures of one page turn together. */
const open = new Set<View>();

export function InSpace({ drawn, view }: { drawn: Schemas["StructureOut"]; view?: { current: View | null } }) {
  const root = useRef<HTMLDivElement>(null);
  const own = useRef<View | null>(null);
  const [odd, setOdd] = useState<View["odd"]>({});
  useStrange(Object.keys(odd).filter((name) => odd[name] === asked(name)));
  const dark = theme.value;
  useEffect(() => {
    if (!root.current) return;
    const made = (own.current = show(root.current, drawn, place.value.query, keep));
    setOdd(made.odd);
    if (view) view.current = made;
    for (const other of open) {
      other.link(made);
      made.link(other);
    }
    open.add(made);
    return () => {
      open.delete(made);
      made.gone();
    };
  }, [drawn]);
  useLayoutEffect(() => own.current?.repaint(), [dark]);
  return <div class="in-space" ref={root} />;
}
