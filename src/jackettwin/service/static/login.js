"use strict";
document.getElementById("login").addEventListener("submit", async (event) => {
  event.preventDefault();
  const form = new FormData(event.target);
  const answer = await fetch("/api/v1/login", {
    method: "POST", headers: { "Content-Type": "application/json" },
    body: JSON.stringify({ name: form.get("name"), password: form.get("password"), new: form.get("new") || null }),
  });
  if (answer.ok) return location.assign("/");
  const problem = await answer.json();
  document.getElementById("problem").textContent = problem.detail;
  if (answer.status === 403 && problem.field === "new") document.getElementById("another").hidden = false;
});
