"""The profiles' own validator of RO-Crates, without a network.

It reads two contexts from the web. The library rocrate brings the terms of RO-Crate along, in version 1.3; of those
that are used, three stand for something else in 1.1, which a crate here keeps to. Both contexts are put into the
validator's cache, and it is told to look nowhere else.
"""

from __future__ import annotations

import json
import warnings
from importlib import resources

import requests
from requests_cache.models import CachedRequest, CachedResponse
from rocrate_validator import services
from rocrate_validator.models import Severity, ValidationSettings
from rocrate_validator.utils.http import HttpRequester

BIOSCHEMAS = "https://bioschemas.org/"
CHANGED_SINCE_1_1 = {
    "ComputationalWorkflow": f"{BIOSCHEMAS}ComputationalWorkflow",
    "FormalParameter": f"{BIOSCHEMAS}FormalParameter",
    "input": f"{BIOSCHEMAS}ComputationalWorkflow#input",
}
WORKFLOW_RUN = {"sha256": "https://w3id.org/ro/terms/workflow-run#sha256"}


def contexts() -> dict[str, dict]:
    """Address → context; of the second, the one term that is used."""
    text = (resources.files("rocrate") / "data/ro-crate.jsonld").read_text(encoding="utf-8")
    rocrate = json.loads(text)
    return {
        "https://w3id.org/ro/crate/1.1/context": {
            "@context": rocrate["@context"] | CHANGED_SINCE_1_1
        },
        "https://w3id.org/ro/terms/workflow-run/context": {"@context": WORKFLOW_RUN},
    }


def issues(folder, cache, profile="provenance-run-crate-0.5") -> list[tuple[str, str]]:
    """What the validator misses in the crate of a folder, (severity, message): what is required or recommended.

    cache : where it may keep what it reads.   profile : with all that it builds on.
    """
    settings = ValidationSettings(
        rocrate_uri=folder,
        profile_identifier=profile,
        requirement_severity=Severity.RECOMMENDED,
        offline=True,
        cache_path=cache,
    )
    store = HttpRequester().session.cache
    for address, context in contexts().items():
        response = CachedResponse(
            status_code=200,
            url=address,
            headers={"Content-Type": "application/ld+json"},
            request=CachedRequest(method="GET", url=address),
        )
        response._content = json.dumps(context).encode()
        store.save_response(response, store.create_key(requests.Request("GET", address).prepare()))
    with warnings.catch_warnings(action="ignore"):  # of the libraries that the validator uses
        found = services.validate(settings).get_issues()
    return [(issue.severity.name, issue.message) for issue in found]
