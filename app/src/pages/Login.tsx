// Who are you?
import { useAnswer } from "../api/answer";
import { api, me, told } from "../api/client";
import { useDeed } from "../api/do";
import { FormEnd } from "../parts/Bits";
import { asked, go } from "../shell/place";

/** Only a place of ours: a link from elsewhere cannot send anybody away by it. */
export function safePlace(next: string | null): string {
  return next && /^\/(?![/\\])/.test(next) ? next : "/";
}

export function Login() {
  const deed = useDeed();
  const health = useAnswer(null, "health", () => told(api.GET("/api/v1/health")));
  const anew = deed.problem?.field === "new";
  const send = async (event: SubmitEvent): Promise<void> => {
    event.preventDefault();
    const form = new FormData(event.currentTarget as HTMLFormElement);
    const text = (name: string): string => String(form.get(name) ?? "");
    const body = { name: text("name"), password: text("password"), new: text("new") || null };
    await deed.run(async () => {
      me.value = await told(api.POST("/api/v1/login", { body }));
      go(safePlace(asked("next")));
    });
  };
  return (
    <main class="narrow" id="main">
      <section class="card" aria-label="Log in">
        <h1>Log in to jackettwin</h1>
        <form class="stack" onSubmit={(event) => void send(event)}>
          <label>
            Name
            <input name="name" autocomplete="username" required />
          </label>
          <label>
            Password
            <input name="password" type="password" autocomplete="current-password" required />
          </label>
          {anew && (
            <label>
              New password, 12 characters or more
              <input name="new" type="password" autocomplete="new-password" minLength={12} required />
            </label>
          )}
          <FormEnd deed={deed} words={deed.busy ? "Asking" : "Log in"} />
        </form>
        {health.data?.openid && (
          <p class="other-way">
            <a class="button" href="/api/v1/oidc/login" data-leave>
              Log in with your organisation's account
            </a>
          </p>
        )}
      </section>
    </main>
  );
}
