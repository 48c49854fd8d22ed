import { describe, expect, test } from "vitest";
import { alarmMarks, binPlot } from "../src/parts/modes";
import { csvOf, extentOf, type PlotData, spanOf, ticksOf, timeTicksOf, wordsOf } from "../src/parts/plot/series";
import { svgOf } from "../src/parts/plot/svg";
import { stiffnessPlot } from "../src/parts/ground";

const plot: PlotData = {
  title: 'side-side "1" <b>',
  yName: "frequency [Hz]",
  series: [
    { name: "a, b", colour: "blue", kind: "points", x: [0, 60], y: [1, null], low: [0.5, null], high: [2, null] },
  ],
  marks: [{ x: 30, words: "alarm", colour: "alarm" }],
};

describe("a plot", () => {
  test("is written with times in UTC and gaps left empty", () => {
    expect(csvOf(plot).split("\n").slice(0, 3)).toEqual([
      "series,time_utc,frequency [Hz],low,high",
      '"a, b",1970-01-01T00:00:00.000Z,1,0.5,2',
      '"a, b",1970-01-01T00:01:00.000Z,,,',
    ]);
  });
  test("has the words of its marks whole and beside one another", () => {
    const marks = [90, 5, 12, 50, 99].map((x) => ({ x, words: "w".repeat(x === 50 ? 80 : 20), colour: "alarm" }));
    const found = wordsOf(marks, (x) => x, (words) => words.length, [0, 100]); // prettier-ignore
    expect(found.map(({ x, at, line }) => [x, at, line])).toEqual([
      [5, 5, 0],
      [12, 12, 1],
      [50, 0, 2], // there is no room on either side: it begins where the plot does
      [90, 70, 0],
      [99, 79, 1],
    ]);
    expect(wordsOf(marks, (x) => x - 60, () => 10, [0, 100]).map((one) => one.x)).toEqual([90, 99]); // prettier-ignore
  });
  test("shows its intervals whole", () => {
    const [low, high] = spanOf(plot, null);
    expect(low).toBeLessThan(0.5);
    expect(high).toBeGreaterThan(2);
    expect(spanOf(plot, [50, 70])).toEqual([0, 1]);
    expect(spanOf({ ...plot, log: true }, null)[0]).toBeGreaterThan(0);
    expect(extentOf(plot)).toEqual([-1.2, 61.2]);
  });
  test("is not hidden by a few wide intervals among many points", () => {
    const [n, wide] = [100, 1000];
    const x = Array.from({ length: n }, (_, i) => i);
    const y = x.map((i) => i % 2);
    const low = x.map((i) => (i === 5 ? -wide : (y[i] ?? 0) - 0.1));
    const series = [{ name: "a", colour: "blue", kind: "points" as const, x, y, low, high: y }];
    const [from, to] = spanOf({ ...plot, series }, null);
    expect(from).toBeGreaterThan(-1);
    expect(from).toBeLessThan(-0.1);
    expect(to).toBeGreaterThan(1);
  });
  test("is scaled by what is known as well as most, and by all where nothing else is shown", () => {
    const x = Array.from({ length: 100 }, (_, i) => i);
    const y = x.map((i) => (i < 98 ? i % 2 : 50));
    const wide = x.map((i) => (i < 98 ? 0.1 : 60));
    const [low, high] = [-1, 1].map((side) => y.map((v, i) => v + side * (wide[i] ?? 0)));
    const series = [{ name: "a", colour: "blue", kind: "points" as const, x, y, low, high }] as PlotData["series"];
    const odd = { ...plot, marks: [], series };
    expect(spanOf(odd, null)[1]).toBeLessThan(2);
    expect(spanOf(odd, [97.5, 100])[1]).toBeGreaterThan(50);
    const heights = [...svgOf(odd, [0, 100], () => "#123456").matchAll(/cy="(\d+)/g)].map((m) => Number(m[1]));
    expect(Math.min(...heights)).toBe(40); // at the edge, not above the plot
  });
  test("tells lines of one colour apart by their strokes, above the curves, and words of near marks by rows", () => {
    const line = { colour: "blue", kind: "line" as const, x: [0, 60], y: [1, 2] };
    const series = [
      { ...line, name: "first" },
      { ...line, name: "second", dash: [7, 4] },
    ];
    const marks = [0, 1].map((x) => ({ x, words: "alarm", colour: "alarm" }));
    const drawn = svgOf({ ...plot, series, marks }, [0, 60], () => "#123456");
    expect(drawn.match(/stroke-dasharray="7 4"/g)).toHaveLength(2);
    const rows = [...drawn.matchAll(/y="([\d.]+)"[^>]*>(second|alarm)</g)].map((m) => Number(m[1]));
    expect(new Set(rows).size).toBe(3);
    expect(Math.min(...rows)).toBe(rows[0]);
  });
  test("counts a year in months and an hour in minutes", () => {
    const at = (from: string, to: string): string[] =>
      timeTicksOf([Date.parse(from) / 1000, Date.parse(to) / 1000], 6).map((t) => new Date(t * 1000).toISOString());
    expect(at("2025-01-15", "2025-12-20").map((t) => t.slice(0, 10))).toEqual([
      "2025-03-01",
      "2025-05-01",
      "2025-07-01",
      "2025-09-01",
      "2025-11-01",
    ]);
    expect(at("2025-01-15T12:01", "2025-01-15T12:59")).toHaveLength(5);
    expect(at("2025-01-15", "2025-01-15")).toHaveLength(0);
  });
  test("is drawn without letting a name become markup", () => {
    const drawn = svgOf(plot, [0, 60], () => "#123456");
    expect(drawn).toContain("side-side &quot;1&quot; &lt;b&gt;");
    expect(drawn).not.toContain("<b>");
    expect(drawn.match(/<circle/g)).toHaveLength(1);
  });
  test("has true minus signs at its axes", () => {
    const below = [{ name: "a", colour: "blue", kind: "line" as const, x: [-3, 3], y: [-2, 2] }];
    const drawn = svgOf({ ...plot, xName: "frequency [Hz]", marks: [], series: below }, [-3, 3], () => "#123456");
    expect(drawn).toContain(">−1</text>");
    expect(drawn).toContain(">−2</text>");
    expect(drawn).not.toMatch(/>-\d/);
  });
  test("has few ticks whatever its range, and a search for them ends", () => {
    let seed = 1; // the same numbers each time, of every size that a number can have
    const random = (): number => (seed = (seed * 48271) % 2147483647) / 2147483647;
    const any = (): number =>
      random() < 0.1
        ? ([0, NaN, Infinity, -Infinity][Math.floor(4 * random())] ?? 0)
        : (random() < 0.5 ? -1 : 1) * 10 ** (-320 + 628 * random());
    for (let i = 0; i < 5000; i++) {
      const low = any();
      const high = random() < 0.3 ? low * (1 + 10 ** (-16 * random())) : any();
      for (const log of [false, true]) expect(ticksOf([low, high], 6, log).length).toBeLessThan(15);
      const from = 3e9 * (random() - 0.1);
      expect(timeTicksOf([from, from + 10 ** (-6 + 17 * random())], 6).length).toBeLessThan(400);
    }
  });
  test("has ticks in steps of 1, 2 or 5", () => {
    expect(ticksOf([0, 1], 5)).toEqual([0, 0.2, 0.4, 0.6, 0.8, 1]);
    expect(ticksOf([-0.09, 0.09], 2)).toEqual([-0.05, 0, 0.05]); // not one alone
    expect(ticksOf([0.2, 30], 5, true)).toEqual([0.2, 0.5, 1, 2, 5, 10, 20]);
    expect(ticksOf([9.7e-9, 0.02], 5, true)).toEqual([1e-8, 1e-6, 1e-4, 1e-2]); // where uPlot's own search does not end
    expect(ticksOf([0.01, 10], 2, true)).toEqual([0.01, 1]); // a narrow window: not 5 and 10 alone
    expect(ticksOf([0.015, 15], 2, true)).toEqual([0.1, 10]);
    expect(ticksOf([18, 46], 5, true)).toEqual([20, 30, 40]);
    expect(ticksOf([1e9, 1e9 + 1e-7], 5).length).toBeLessThan(9);
    for (const none of [ticksOf([0, 1], 5, true), ticksOf([1, 1], 5), ticksOf([0, Infinity], 5)])
      expect(none).toEqual([]);
  });
});

describe("many modes", () => {
  const extremes = { min: [0.01, null], median: [0.02, null], max: [0.03, null] };
  const bins = {
    label: "fore_aft_1",
    start_utc: "1970-01-01T00:01:00Z",
    bin_s: 20,
    time_s: [0, 40],
    count: [3, 1],
    frequency_hz: { min: [0.3, 0.4], median: [0.31, 0.4], max: [0.33, 0.4] },
    damping_ratio: extremes,
    simulated: 0,
  };
  test("are drawn as extremes and medians in the middle of their bins", () => {
    const [band, median] = binPlot(bins, "frequency", []).series;
    expect(band).toMatchObject({ kind: "band", x: [70, 110], low: [0.3, 0.4], high: [0.33, 0.4] });
    expect(median).toMatchObject({ kind: "points", y: [0.31, 0.4] });
  });
  test("have damping in percent, and none where no record has one", () => {
    const [band, median] = binPlot(bins, "damping", []).series;
    expect([band?.low, median?.y, band?.high]).toEqual([
      [1, null],
      [2, null],
      [3, null],
    ]);
  });
});

describe("the ground's stiffness", () => {
  const of = (version: number, medians: Record<string, number>) => ({
    asset: "wtg",
    version,
    days: [],
    statement: "",
    units: {},
    stiffness_in_time: {
      smoothed: Object.fromEntries(
        Object.entries(medians).map(([k, median]) => [k, { median, interval_90: [0, 2] }]),
      ),
      changes: [],
      forecast: [],
    },
  });
  test("is drawn by the adopted version with its interval, and by each other one that has days", () => {
    const two = { "2025-03-02": 0.9, "2025-03-01": 1 };
    const { series } = stiffnessPlot(of(1, two), [of(3, { "2025-03-02": 0.8 }), of(2, {})]);
    expect(series.map((s) => [s.name, Array.from(s.y)])).toEqual([
      ["90 % by now", [1, 0.9]],
      ["known by now, version 1", [1, 0.9]],
      ["version 3", [0.8]],
    ]);
  });
});

test("an alarm is marked from the day that the change began to the one on which it was found", () => {
  const found = { time_utc: "2025-04-28T00:00:00Z", params: { began: "2025-04-15" } } as never;
  const [{ x = 0, to = 0, words = "" } = {}] = alarmMarks([found]);
  expect([(to - x) / 86_400, words]).toEqual([13, "began 2025-04-15, alarm 2025-04-28"]);
});
