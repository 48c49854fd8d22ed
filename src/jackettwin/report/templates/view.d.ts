/** The widget as TypeScript sees it: see view.js. */
export interface View {
  /** What the address asks for and is not here, by name. */
  readonly odd: Readonly<Record<string, string>>;
  focus(): void;
  repaint(): void;
  link(other: View): void;
  stand(seconds: number): void;
  gone(): void;
}
type Asked = Pick<URLSearchParams, "get">;
type Keep = (values: Record<string, string | null>) => void;
export function show(root: HTMLElement, drawn: unknown, asked?: Asked, keep?: Keep): View;
