// Who may what, and who did what.
import { useAnswer } from "../api/answer";
import { api, type Schemas, told } from "../api/client";
import { may } from "../api/do";
import { Card, Field, Form, Head, Time } from "../parts/Bits";
import { Empty, Shown } from "../parts/Shown";
import { Table } from "../parts/Table";

type Role = Schemas["UserOut"]["role"];

function Add({ again }: { again: () => void }) {
  const send = async (text: (name: string) => string): Promise<void> => {
    const assets = text("assets").match(/[^\s,]+/g); // null of none: all of them
    const own = { name: text("name"), role: text("role") as Role, password: text("password") };
    await told(api.POST("/api/v1/users", { body: { ...own, assets } }));
    again();
  };
  return (
    <Form words="Add" onSend={send}>
      <Field label="Name" name="name" required autocomplete="off" />
      <label>
        Role
        <select name="role">
          <option value="viewer">viewer: reads</option>
          <option value="engineer">engineer: sends records, picks, acknowledges, adopts</option>
          <option value="admin">admin: also users and archives</option>
        </select>
      </label>
      <Field
        label="Password, 12 characters or more"
        name="password"
        type="password"
        minLength={12}
        required
        autocomplete="new-password"
      />
      <Field label="Turbines to see, separated by commas; empty for all" name="assets" />
    </Form>
  );
}

export default function Users() {
  const users = useAnswer("", "users", () => told(api.GET("/api/v1/users")));
  const audit = useAnswer("", "audit", () => told(api.GET("/api/v1/audit", { params: { query: { limit: 100 } } })));
  return (
    <>
      <Head title="Users">
        With the first user, everybody needs a login. Until then this server answers to its own machine only.
      </Head>
      <div class="grid">
        <Card title="Who may log in">
          <Shown of={users} none={<Empty title="No user yet" />}>
            {(data) => (
              <Table
                label="Users"
                rows={data.items}
                id={(u) => u.name}
                columns={[
                  { title: "Name", show: (u) => u.name, by: (u) => u.name },
                  { title: "Role", show: (u) => (u.disabled ? "disabled" : u.role), by: (u) => u.role },
                  { title: "Sees", show: (u) => u.assets?.join(", ") ?? "all" },
                  { title: "Until", show: (u) => (u.expires_utc ? <Time at={u.expires_utc} short /> : "") },
                ]}
              />
            )}
          </Shown>
        </Card>
        {may("admin") && (
          <Card title="Add somebody" note="The first one should be an admin: yourself.">
            <Add again={users.again} />
          </Card>
        )}
        <Card title="Who did what" wide>
          <Shown of={audit} none={<Empty title="Nothing yet" />}>
            {(data) => (
              <Table
                label="Audit log"
                rows={data.items}
                id={(a) => String(a.id)}
                columns={[
                  { title: "When", show: (a) => <Time at={a.time_utc} /> },
                  { title: "Who", show: (a) => a.who },
                  { title: "Did", show: (a) => a.action },
                  { title: "To", show: (a) => <span class="prose">{a.subject}</span> },
                  { title: "Outcome", show: (a) => a.outcome },
                ]}
              />
            )}
          </Shown>
        </Card>
      </div>
    </>
  );
}
