// Who are you?
import { useState } from "preact/hooks";
import { useAnswer } from "../api/answer";
import { api, me, Problem, told } from "../api/client";
import { asked, go } from "../shell/place";

/** Only a place of ours: a link from elsewhere cannot send anybody away by it. */
export function safePlace(next: string | null): string {
  return next && /^\/(?![/\\])/.test(next) ? next : "/";
}

export function Login() {
  const [problem, setProblem] = useState<Problem | null>(null);
  const [busy, setBusy] = useState(false);
  const health = useAnswer(null, "health", () => told(api.GET("/api/v1/health")));
  const anew = problem?.field === "new";
  const send = async (event: SubmitEvent): Promise<void> => {
    event.preventDefault();
    const form = new FormData(event.currentTarget as HTMLFormElement);
    const text = (name: string): string => String(form.get(name) ?? "");
    setBusy(true);
    try {
      const body = { name: text("name"), password: text("password"), new: text("new") || null };
      me.value = await told(api.POST("/api/v1/login", { body }));
      go(safePlace(asked("next")));
    } catch (error) {
      setProblem(error instanceof Problem ? error : null);
    }
    setBusy(false);
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
          {problem && (
            <p class="error" role="alert">
              {problem.message}
            </p>
          )}
          <button class="main" disabled={busy}>
            {busy ? "Asking" : "Log in"}
          </button>
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
