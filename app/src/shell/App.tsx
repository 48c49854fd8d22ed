// The frame: who is logged in, where the reader is, and the page of that place.
import { Suspense } from "preact/compat";
import type { ComponentType } from "preact";
import { useEffect } from "preact/hooks";
import { api, ended, me } from "../api/client";
import { connection, listen, stopListening } from "../api/events";
import { askWho, may } from "../api/do";
import { Fleet } from "../pages/Fleet";
import { Login } from "../pages/Login";
import { Turbine } from "../pages/Turbine";
import { Press } from "../parts/Bits";
import { later } from "../parts/later";
import { Empty } from "../parts/Shown";
import { asked, assetUrl, go, place, route, strange, stretch, useChosen, useStrange, type PageProps } from "./place";
import { printPage, savePage } from "./paper";
import { switchTheme, theme } from "./theme";

const titled = (key: string): string => (key ? key.charAt(0).toUpperCase() + key.slice(1) : "Turbine");
type Loaded = { default: ComponentType<PageProps> };
const LATER = import.meta.glob<Loaded>(["../pages/*.tsx", "!../pages/{Fleet,Login,Turbine}.tsx"]);
/** Pages with plots come when they are first asked for. */
const PAGES: Record<string, ComponentType<PageProps>> = { fleet: Fleet, turbine: Turbine };
for (const [path, load] of Object.entries(LATER))
  PAGES[path.slice("../pages/".length, -".tsx".length).toLowerCase()] = later(load);
const TABS = ["", ..."live timeline structure explore life records alarms model reports".split(" ")];
const OWN_TABS: readonly (readonly [string, string, string])[] = [
  ["/", "Turbines", "viewer"],
  ["/jobs", "Jobs", "viewer"],
  ["/start", "New turbine", "engineer"],
  ["/users", "Users", "admin"],
  ["/docs", "API", "viewer"],
];

addEventListener("focus", () => ended.value && void askWho()); // somebody may have logged in beside it
void askWho(); // beside the first answers of the page, not before them

async function logOut(): Promise<void> {
  await api.POST("/api/v1/logout").catch(() => undefined);
  me.value = null;
}

/** What the link asks for and this page does not have. */
function Strange() {
  useChosen("theme", ["light", "dark"]);
  useStrange(["from", "to"].filter((end) => asked(end) !== null && stretch.value === null));
  const said = Object.entries(strange.value).map(([name, value]) => `${name} = ${value}`);
  if (!said.length) return null;
  return (
    <p class="strange" role="status">
      The link asks for what is not here, and the usual is shown instead: {said.join(", ")}.
    </p>
  );
}

function Top() {
  const { asset, page } = route.value;
  const { path } = place.value;
  const here = page === "turbine" ? "" : page === "record" ? "records" : page;
  const [state, user] = [connection.value, me.value];
  return (
    <header class="top">
      <div class="row">
        <a class="brand" href="/">
          jackettwin
        </a>
        {asset && (
          <nav class="where" aria-label="Turbine">
            <span aria-hidden="true">/</span>
            <a href={assetUrl(asset)}>{asset}</a>
          </nav>
        )}
        <div class="who">
          <span class={`link-state ${state}`} role="status" title={`Connection: ${state}`}>
            <span>{state === "live" ? "live" : state === "lost" ? "no connection" : "connecting"}</span>
          </span>
          <Press words="Print or PDF" look="wide-only" act={printPage} />
          <Press words="HTML" look="wide-only" act={savePage} />
          <button
            type="button"
            onClick={switchTheme}
            aria-label={`Show in ${theme.value === "dark" ? "light" : "dark"} colours`}
          >
            {theme.value === "dark" ? "Light" : "Dark"}
          </button>
          {user && <span class="name">{`${user.name} (${user.role})`}</span>}
          {user?.csrf_token && <Press words="Log out" act={logOut} />}
        </div>
      </div>
      <nav class="tabs" aria-label="Pages">
        {(asset ? TABS.map((key) => [assetUrl(asset, key), titled(key), key] as const) : OWN_TABS).map(
          ([url, words, key]) =>
            (asset || may(key)) && (
              <a key={url} href={url} {...((asset ? key === here : url === path) ? { "aria-current": "page" } : {})}>
                {words}
              </a>
            ),
        )}
      </nav>
    </header>
  );
}

export function App() {
  const user = me.value;
  const { page, asset, id } = route.value;
  useEffect(() => {
    if (user === null && page !== "login")
      go(`/login?next=${encodeURIComponent(place.value.path + location.search)}`, true);
    if (user && !ended.value) listen();
    else stopListening();
  }, [user, page, ended.value]);
  useEffect(() => {
    const here = document.querySelector(".tabs [aria-current]"); // on a phone the row is longer than the screen
    here?.scrollIntoView({ inline: "center", block: "nearest" });
    const parts = [asset, page === "turbine" ? "" : page, "jackettwin"];
    document.title = parts.filter(Boolean).join(" – ");
  }, [asset, page]);
  if (page === "login") return <Login />;
  const Page = PAGES[page];
  return (
    <>
      {ended.value && <Login />}
      <div hidden={ended.value}>
        <a class="skip" href="#main">
          To the page
        </a>
        <Top />
        {connection.value === "lost" && (
          <p class="offline" role="alert">
            The server does not answer. What is shown is as it was; it is asked again by itself.
          </p>
        )}
        <main id="main" tabIndex={-1}>
          <Strange />
          {user !== null && (
            <Suspense fallback={<div class="bones" role="status" aria-label="Loading" />}>
              {Page ? (
                <Page key={`${page} ${asset} ${id}`} asset={asset} id={id} />
              ) : (
                <Empty title="There is no such page">
                  Go to <a href="/">all turbines</a>.
                </Empty>
              )}
            </Suspense>
          )}
        </main>
      </div>
    </>
  );
}
