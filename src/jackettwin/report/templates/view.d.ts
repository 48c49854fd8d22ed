// The report's widget (src/jackettwin/report/templates/view.js), as this window sees it.
declare module "*/templates/view.js" {
  export interface View {
    focus(): void;
    repaint(): void;
    link(other: View): void;
    stand(seconds: number): void;
    gone(): void;
  }
  export function show(root: HTMLElement, drawn: unknown, asked?: Map<string, string>): View;
}
