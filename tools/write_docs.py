"""Write the parts of the documents that are made from the code: of settings, of labels, of plans of
maps, model cards, tables of figures, and the leaderboard of what ships.

python tools/write_docs.py           # writes them
python tools/write_docs.py --check   # ends with 1 if they are not up to date
"""

import argparse
import json
import sys
from pathlib import Path

import looks_bench
import site_reference
from plan_page import page_of_records, schema_text
from standings import standings
from version import REPOSITORY

from eyas.benchmark.policies.shipped import shipped_names
from eyas.benchmark.report.reproduce.model_card import model_card
from eyas.benchmark.report.reproduce.run import markdown
from eyas.benchmark.report.reproduce.tables import TABLES, expected
from eyas.cli.bench.measurement import Measurement, measurement_cells
from eyas.dat.settings.keys import ENTRIES
from eyas.dat.settings.layout import original_defaults
from eyas.engine.exports.label import FIELDS, LabelField, label_schema
from eyas.engine.settings.schema import config_schema

DOCS = Path(__file__).parents[1] / "docs"
BEGIN, END = "<!-- made by tools/write_docs.py -->", "<!-- end -->"


def label_table() -> str:
    """Return the table of the fields of the labels."""
    rows = [
        "| of the frame, or target | of each of `others` | type | unit | frame of reference | |",
        "|---|---|---|---|---|---|",
    ]
    rows += map(_row, FIELDS)
    return "\n".join(rows)


def _row(field: LabelField) -> str:
    others = f"`{field.others}`" if field.others else ""
    key = f"`{field.key}`" if field.key else ""
    cells = (key, others, field.type.name, field.unit, field.frame, field.meaning)
    return f"| {' | '.join(cells)} |"


def speed_table() -> str:
    """Return what `eyas bench --out bench/results.json` has measured."""
    found = json.loads((DOCS.parent / "bench" / "results.json").read_text())
    results = [Measurement(**result) for result in found["results"]]
    rows = ["| measurement | median | CPU time of one | includes |", "|---|---|---|---|"]
    for result in results:
        name, value, unit, cpu, includes = measurement_cells(result)
        rows.append(f"| {name} | {value} {unit} | {cpu} | {includes} |")
    title = f"`eyas bench` of Eyas {found['eyas']} on {found['machine']}:"
    return "\n".join([title, "", *rows])


def original_keys() -> str:
    """Return the table of the keys of the original's `env_config.json`."""
    rows = ["| original's key | value if missing | native setting |", "|---|---|---|"]
    for entry in ENTRIES:
        ours = ", ".join(f"`{path}`" for path in entry.paths)
        for key in entry.keys:
            group, _, name = key.rpartition(".")
            known = original_defaults()
            default = json.dumps(known[group][name] if group else known[name])
            rows.append(f"| `{key}` | `{default}` | {ours} |")
    return "\n".join(rows)


def looks_tables() -> str:
    """Return what `tools/looks_bench.py` has measured."""
    found = json.loads((DOCS.parent / "bench" / "looks.json").read_text())
    title = f"Seed {found['seed']}, world `{found['build']}`:"
    return "\n".join(
        [title, "", *(looks_bench.table(found[kind], {}) for kind in ("pictures", "detectors"))]
    )


def settings_schema() -> str:
    """Return the JSON schema of the settings, with the address by which editors find it."""
    schema = {"$id": f"{REPOSITORY}/raw/main/docs/settings.schema.json", **config_schema()}
    return json.dumps(schema, ensure_ascii=False) + "\n"


def made(page: str, table: str) -> str:
    """Return a page with its made part replaced."""
    head, rest = page.split(BEGIN)
    return f"{head}{BEGIN}\n\n{table}\n\n{END}{rest.split(END)[1]}"


def documents() -> dict[Path, str]:
    """Return the texts of all files that are made."""
    labels = DOCS / "labels.md"
    schema = json.dumps(label_schema(), indent=2, ensure_ascii=False) + "\n"
    plan, leaders = DOCS / "maps" / "plan.md", DOCS / "leaderboard.md"
    speed, looks = DOCS / "speed.md", DOCS / "looks.md"
    settings, files = DOCS / "reference" / "settings.md", DOCS / "configuration.md"
    return {
        speed: made(speed.read_text(), speed_table()),
        looks: made(looks.read_text(), looks_tables()),
        leaders: made(leaders.read_text(), standings()),
        settings: made(settings.read_text(), site_reference.settings()),
        files: made(files.read_text(), original_keys()),
        labels: made(labels.read_text(), label_table()),
        DOCS / "labels.schema.json": schema,
        DOCS / "settings.schema.json": settings_schema(),
        plan: made(plan.read_text(), page_of_records()),
        DOCS / "maps" / "plan.schema.json": schema_text(),
        **{DOCS / "policies" / f"{name}.md": model_card(name) + "\n" for name in shipped_names()},
        **tables(),
    }


def tables() -> dict[Path, str]:
    """Return the texts of the pages that have tables of `eyas reproduce`."""
    pages: dict[Path, str] = {}
    for table in TABLES.values():
        path, said = DOCS / table.page, expected(table.name)
        page = pages.get(path) or path.read_text()
        begin, end = f"<!-- table {table.name} -->", "<!-- end of table -->"
        if begin not in page:
            raise SystemExit(f"{path}: has no place for the table: {begin} ... {end}")
        head, rest = page.split(begin)
        text = "(not made yet)" if said is None else markdown(table, said)
        command = f"`eyas reproduce {table.name}`"
        pages[path] = f"{head}{begin}\n\n{text}\n\n{command}\n{end}{rest.split(end, 1)[1]}"
    path = DOCS / "reproduce.md"
    begin, end = "<!-- tables of eyas reproduce -->", "<!-- end of tables -->"
    head, rest = (pages.get(path) or path.read_text()).split(begin)
    rows = ["| table | episodes | where | command |", "|---|---|---|---|"]
    rows += [
        f"| {table.title} | {sum(row.episodes for row in table.rows):,} | "
        f"[{table.page}]({table.page}) | `eyas reproduce {table.name}` |"
        for table in TABLES.values()
    ]
    listed = "\n".join(rows)
    pages[path] = f"{head}{begin}\n\n{listed}\n\n{end}{rest.split(end, 1)[1]}"
    return pages


def main() -> int:
    """Write the files, or tell which are not up to date."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="write nothing")
    check = parser.parse_args().check
    stale = [
        (path, text)
        for path, text in documents().items()
        if not path.exists() or path.read_text() != text
    ]
    for path, text in stale:
        print(f"{path.relative_to(DOCS.parent)}: {'not up to date' if check else 'written'}")
        if not check:
            path.write_text(text)
    return int(check and bool(stale))


if __name__ == "__main__":
    sys.exit(main())
