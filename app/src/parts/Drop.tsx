// Where files are dropped or chosen, folders with all that lies in them.
import type { ComponentChildren } from "preact";
import { useState } from "preact/hooks";

const asked = <T,>(ask: (ok: (answer: T) => void, no: (error: unknown) => void) => void): Promise<T> =>
  new Promise(ask);

/** The files of what was dropped; a folder says a part of its own at a time. */
async function filesOf(entry: FileSystemEntry | null): Promise<File[]> {
  if (entry?.isFile) return [await asked<File>((ok, no) => (entry as FileSystemFileEntry).file(ok, no))];
  if (!entry?.isDirectory) return [];
  const reader = (entry as FileSystemDirectoryEntry).createReader();
  const found: File[] = [];
  for (;;) {
    const some = await asked<FileSystemEntry[]>((ok, no) => reader.readEntries(ok, no));
    if (!some.length) return found;
    for (const one of some) found.push(...(await filesOf(one)));
  }
}

type DropProps = { label: string; onFiles: (files: File[]) => void; children: ComponentChildren };

export function Drop({ label, onFiles, children }: DropProps) {
  const [over, setOver] = useState(false);
  const drop = (event: DragEvent): void => {
    event.preventDefault();
    setOver(false);
    const entries = [...(event.dataTransfer?.items ?? [])].map((item) => item.webkitGetAsEntry());
    void Promise.all(entries.map(filesOf)).then((files) => onFiles(files.flat()));
  };
  const hover = (event: DragEvent): void => {
    event.preventDefault();
    setOver(true);
  };
  const choose = (event: { currentTarget: HTMLInputElement }): void => {
    onFiles([...(event.currentTarget.files ?? [])]);
    event.currentTarget.value = "";
  };
  return (
    <div class={over ? "drop over" : "drop"} onDragOver={hover} onDragLeave={() => setOver(false)} onDrop={drop}>
      <input type="file" multiple aria-label={label} onChange={choose} />
      {children}
    </div>
  );
}
