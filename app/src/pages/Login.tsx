// Who are you?
import { useAnswer } from "../api/answer";
import { api, ended, told } from "../api/client";
import { enter } from "../api/do";
import { Field, Form } from "../parts/Bits";
import { asked, go } from "../shell/place";

/** Only a place of ours: a link from elsewhere cannot send anybody away by it. */
export function safePlace(next: string | null): string {
  return next && /^\/(?![/\\])\S*$/.test(next) ? next : "/"; // browsers leave out tabs: "/", tab, "/elsewhere"
}

export function Login() {
  const health = useAnswer(null, "health", () => told(api.GET("/api/v1/health")));
  const send = async (text: (name: string) => string): Promise<void> => {
    const body = { name: text("name"), password: text("password"), new: text("new") || null };
    const inside = !ended.value;
    enter(await told(api.POST("/api/v1/login", { body })));
    if (inside) go(safePlace(asked("next")));
  };
  return (
    <main class="narrow">
      <section class="card" aria-label="Log in">
        <h1>Log in to jackettwin</h1>
        {(ended.value || asked("next")) && (
          <p class="quiet">
            Nobody is logged in, or no longer: then you are back where you were, with what you wrote.
          </p>
        )}
        <Form words="Log in" busy="Asking" onSend={send}>
          {(problem) => (
            <>
              <Field label="Name" name="name" autocomplete="username" required />
              <Field label="Password" name="password" type="password" autocomplete="current-password" required />
              {problem?.field === "new" && (
                <Field
                  label="New password, 12 characters or more"
                  name="new"
                  type="password"
                  autocomplete="new-password"
                  minLength={12}
                  required
                />
              )}
            </>
          )}
        </Form>
        {health.data?.openid && (
          <p class="other-way">
            <a class="button" href="/api/v1/oidc/login" data-leave {...(ended.value ? { target: "_blank" } : {})}>
              Log in with your organisation's account
            </a>
          </p>
        )}
      </section>
    </main>
  );
}
