// Small parts that every page uses.
import type { ComponentChildren, InputHTMLAttributes } from "preact";
import type { Problem } from "../api/client";
import { useDeed } from "../api/do";
import { asked, chosen, keep, numberAsked, type Options, useStrange } from "../shell/place";
import { ago, local, utc } from "../words/time";

const SAID: Record<string, string> = {
  ok: "Nothing to do",
  warning: "Look when you can",
  alarm: "Look now",
  "no data": "No data yet",
};

/** The light: a shape and a word beside its colour. */
export function Light({ status, long = false }: { status: string; long?: boolean }) {
  const name = status.replaceAll(" ", "-").replaceAll("_", "-");
  return (
    <span class={`light ${name}`}>
      <i aria-hidden="true" />
      {long ? (SAID[status] ?? status) : status.replaceAll("_", " ")}
    </span>
  );
}

/** A time in UTC; the reader's own clock on hover. */
export function Time({ at, short = false }: { at: string; short?: boolean }) {
  return (
    <time dateTime={at} title={local(at)}>
      {short ? utc(at).slice(0, 10) : `${utc(at)} UTC`}
    </time>
  );
}

export function Ago({ at }: { at: string }) {
  return (
    <time dateTime={at} title={`${utc(at)} UTC · ${local(at)}`}>
      {ago(at, Date.now())}
    </time>
  );
}

export function Head({ title, said, children }: { title: string; said?: boolean; children: ComponentChildren }) {
  return (
    <div class="head">
      <h1>{title}</h1>
      {children && <p class={said ? "said" : ""}>{children}</p>}
    </div>
  );
}

type CardProps = { title: string; note?: ComponentChildren; wide?: boolean; more?: ComponentChildren };

export function Card({ title, note, wide, more, children }: CardProps & { children: ComponentChildren }) {
  return (
    <section class={wide ? "card wide" : "card"} aria-label={title}>
      <header>
        <h2>{title}</h2>
        {more && <span class="more">{more}</span>}
      </header>
      {note && <p class="note">{note}</p>}
      {children}
    </section>
  );
}

type PressProps = { words: string; act: () => unknown; off?: boolean; look?: string };

/** A button that does something at once, unless it is off. */
export const Press = ({ words, act, off = false, look = "" }: PressProps) => (
  <button type="button" class={look} disabled={off} onClick={() => void act()}>
    {words}
  </button>
);

interface ChoiceProps {
  label: string;
  options: Options;
  /** The choice stands in the address under this name, unless it is the usual one: the first, if none is said. */
  kept?: string;
  usual?: string;
  value?: string;
  onChoose?: (value: string) => void;
}

function choosing({ options, kept, usual, value = "", onChoose }: ChoiceProps): [string, (value: string) => void] {
  const first = usual ?? pairs(options)[0]?.[0];
  if (kept) return [chosen(kept, options, first), (one) => keep({ [kept]: one === first ? null : one })];
  return [value, (one) => onChoose?.(one)];
}

/** A few things of which one is chosen. */
export function Choice(props: ChoiceProps) {
  const { label, options } = props;
  const [value, choose] = choosing(props);
  return (
    <span class="choice" role="group" aria-label={label}>
      {pairs(options).map(([key, words]) => (
        <button type="button" key={key} aria-pressed={key === value} onClick={() => choose(key)}>
          {words}
        </button>
      ))}
    </span>
  );
}

const pairs = (options: Options): (readonly [string, string])[] =>
  options.map((one) => (typeof one === "string" ? [one, one] : one));

/** One of many things: a list to open, named beside it or only to who cannot see it. */
export function Pick(props: ChoiceProps & { bare?: boolean }) {
  const { label, options, bare } = props;
  const [value, choose] = choosing(props);
  return (
    <label class="pick">
      {!bare && `${label} `}
      <select aria-label={label} value={value} onChange={(event) => choose(event.currentTarget.value)}>
        {pairs(options).map(([key, words]) => (
          <option key={key} value={key}>
            {words}
          </option>
        ))}
      </select>
    </label>
  );
}

/** What is sought, which stands in the address. */
export const Find = ({ label }: { label: string }) => (
  <input
    type="search"
    aria-label={label}
    placeholder={label}
    value={asked("find") ?? ""}
    onInput={(event) => keep({ find: event.currentTarget.value || null })}
  />
);

/** A number by slider, with the name that it has in the address, where it stands at first, and its limits. */
export type Slider = { name: string; usual: number; min?: number; max: number; step?: number | "any" };
export const slid = ({ name, usual, min = 0, max }: Slider): number => numberAsked(name, min, max) ?? usual;

/** A slider with its words above. */
export function Slide({ of, children }: { of: Slider; children: ComponentChildren }) {
  const [{ name, usual, min = 0, max, step = 1 }, at] = [of, slid(of)];
  useStrange(asked(name) !== null && numberAsked(name, min, max) === null ? [name] : []);
  const moved = ({ currentTarget: { value } }: { currentTarget: HTMLInputElement }): void =>
    keep({ [name]: Number(value) === usual ? null : String(Number(Number(value).toFixed(3))) });
  return (
    <label class="slide">
      <span>{children}</span>
      <input type="range" min={min} max={max} step={step} value={at} onInput={moved} />
    </label>
  );
}

/** Names and values, a row each; of several values each has its own. */
export function Facts({ facts }: { facts: readonly (readonly [string, string | string[]])[] }) {
  return (
    <dl class="facts">
      {facts.map(([name, value]) => (
        <div key={name}>
          <dt>{name}</dt>
          {[value].flat().map((one) => (
            <dd key={one}>{one}</dd>
          ))}
        </div>
      ))}
    </dl>
  );
}

export const Field = ({ label, ...more }: { label: string } & InputHTMLAttributes) => (
  <label>
    {label}
    <input {...more} />
  </label>
);

interface FormProps {
  words: string;
  /** What the button says while the server is at it. */
  busy?: string;
  /** What to do with what was written, by the names of the fields. */
  onSend: (text: (name: string) => string) => Promise<unknown>;
  onLeave?: () => void;
  children: ComponentChildren | ((problem: Problem | null) => ComponentChildren);
}

/** Fields, why sending them failed, the button, and a way out. */
export function Form({ words, busy, onSend, onLeave, children }: FormProps) {
  const deed = useDeed();
  const send = async (event: SubmitEvent): Promise<void> => {
    event.preventDefault();
    const form = event.currentTarget as HTMLFormElement;
    const of = new FormData(form);
    if (await deed.run(() => onSend((name) => String(of.get(name) ?? "")))) form.reset();
  };
  return (
    <form class="stack" onSubmit={(event) => void send(event)}>
      {typeof children === "function" ? children(deed.problem) : children}
      {deed.problem && (
        <p class="error" role="alert">
          {deed.problem.message} {deed.problem.remedy}
        </p>
      )}
      <span>
        <button class="main" disabled={deed.busy}>
          {deed.busy ? (busy ?? words) : words}
        </button>{" "}
        {onLeave && <Press words="Not now" act={onLeave} />}
      </span>
    </form>
  );
}
