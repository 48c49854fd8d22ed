"""Every answer to anything that fits the OpenAPI document is declared in it, and none is a fault of ours."""

from collections import Counter
from importlib import import_module
from pkgutil import iter_modules

import schemathesis
from fastapi.testclient import TestClient
from hypothesis import HealthCheck, Phase, given, settings
from requests import Request
from schemathesis.checks import (
    content_type_conformance,
    not_a_server_error,
    response_schema_conformance,
    status_code_conformance,
)
from tests.service.conftest import turn, upload

from jackettwin.service.context import Service
from jackettwin.service.web import auth, schemas
from jackettwin.service.web.schemas.common import Page
from jackettwin.store import people, writing

CHECKS = (
    not_a_server_error,
    status_code_conformance,
    content_type_conformance,
    response_schema_conformance,
)
SUBJECTS = [import_module(f"{schemas.__name__}.{m.name}") for m in iter_modules(schemas.__path__)]
EXAMPLES = 8
"""Requests a route: enough for every kind of value that a generator likes to try first."""
ENDLESS = ("/api/v1/events", "/api/v1/assets/{asset}/live")


def test_everything_sent_and_answered_has_an_example_that_holds(client: TestClient) -> None:
    document = client.get("/api/v1/openapi.json").json()
    contents = [
        content["schema"]
        for path in document["paths"].values()
        for operation in path.values()
        for said in (operation.get("requestBody", {}), *operation["responses"].values())
        for kind, content in said.get("content", {}).items()
        if kind == "application/json"
    ]
    names = {schema["$ref"].rpartition("/")[2] for schema in contents} - {"Page_dict_str__object__"}
    assert len(names) > 30
    for name in names:
        example = document["components"]["schemas"][name]["example"]
        of = name.removeprefix("Page_").removesuffix("_")
        (one,) = {vars(home)[of] for home in SUBJECTS if of in vars(home)}
        known = one if of == name else Page[one]
        assert (
            known.model_validate(example).model_dump(mode="json", exclude_unset=True).keys() == example.keys()
        )


def test_answers_are_declared_and_never_our_fault(
    client: TestClient, service: Service, password_hash: str
) -> None:
    """Asked by somebody who may everything, half of the time of what there is, so that not all is refused."""
    there = {"asset": "wtg", "record_id": upload(client, 1).json()["record_id"], "job_id": 1, "version": 1}
    turn(service)
    schema = schemathesis.openapi.from_dict(client.get("/api/v1/openapi.json").json())
    with writing(service.database) as connection:
        people.add_user(connection, people.User("root", "admin", password_hash, service.now()))
    answered: Counter[int] = Counter()
    for found in schema.get_all_operations():
        operation = found.ok()
        if operation.path in ENDLESS:
            continue

        @settings(
            max_examples=EXAMPLES,
            deadline=None,
            database=None,
            derandomize=True,
            phases=[Phase.explicit, Phase.generate],
            suppress_health_check=list(HealthCheck),
        )
        @given(case=operation.as_strategy())
        def ask(case) -> None:
            if answered.total() % 2:
                case.path_parameters.update({n: v for n, v in there.items() if n in case.path_parameters})
            with writing(service.database) as connection:  # anew each time: one of them is to log out
                secret, _ = auth.new_grant(connection, "root", "token", "", service.now(), auth.TOKEN)
            arguments = case.as_transport_kwargs(base_url="http://127.0.0.1:8470")
            sent = Request(**{k: v for k, v in arguments.items() if k != "cookies"}).prepare()
            body = sent.body.encode() if isinstance(sent.body, str) else sent.body or b""
            headers = {**sent.headers, "Authorization": f"Bearer {secret}"}
            answer = client.request(sent.method, sent.url, headers=headers, content=body)
            answered[answer.status_code] += 1
            case.validate_response(answer, checks=list(CHECKS))

        ask()
    assert sum(n for status, n in answered.items() if status < 300) > 100
    assert answered[401] < 0.2 * answered.total()
