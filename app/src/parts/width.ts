// How wide a part of the page is, for what is drawn and not laid out.
import type { RefObject } from "preact";
import { useLayoutEffect, useState } from "preact/hooks";
import { onPaper } from "../shell/theme";

/** Its width [px], 0 before it is there; measured before the browser paints or prints. */
export function useWidth(root: RefObject<Element | null>): number {
  const [width, setWidth] = useState(0);
  useLayoutEffect(() => {
    const see = (): void => setWidth(root.current?.clientWidth ?? 0);
    const observer = new ResizeObserver(see);
    if (root.current) observer.observe(root.current);
    see();
    return () => observer.disconnect();
  }, [onPaper.value]);
  return width;
}
