"""What docs/formats.md says of a dataset."""

import tomllib

from tests.commands.documented import DOCS, documented
from tsas_cli.recordings.columns import BY_NAME
from tsas_cli.recordings.manifest import Manifest, RigSheet, Run


def test_every_key_and_column_of_a_dataset_is_documented():
    keys = {key for table in (Manifest, RigSheet, Run) for key in table.model_fields}
    assert documented("dataset.toml") == keys | set(BY_NAME)


def test_the_documented_manifest_is_one():
    page = (DOCS / "formats.md").read_text(encoding="utf-8")
    manifest = Manifest.model_validate(tomllib.loads(page.split("```toml\n")[1].split("```")[0]))
    assert not manifest.unknown_keys()
    assert not manifest.rig.unknown_keys() | manifest.run[0].unknown_keys()
