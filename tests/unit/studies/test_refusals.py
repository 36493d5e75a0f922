"""A study that cannot be run is refused in a sentence that names the file, the key and the remedy."""

from __future__ import annotations

import pytest

from dampbalance.project.documents import ConfigurationError
from unit.studies.documents import REFUSALS, document


@pytest.mark.parametrize(("name", "change", "words"), REFUSALS)
def test_a_wrong_study_is_refused_in_one_sentence(make, name, change, words):
    if words is None:
        make(document(name, **change))
        return
    with pytest.raises(ConfigurationError) as caught:
        make(document(name, **change))
    assert words in str(caught.value)
    assert str(caught.value).count("test.yaml: ") == len(str(caught.value).splitlines())
