# What the stepped-sine tables of a bolted beam say: make CONFIG=config/beam.yaml, where they are (config/records/beam/README.md).
#
# The rule exists only where the configuration has the section `beam`, for nothing else knows which tables it is about.

BEAM_FILES = {}

if config.get("beam"):
    BEAM = config["beam"]
    BEAM_FILES = {
        "page": f"{RESULTS}/beam.md",
        "numbers": f"{RESULTS}/beam.json",
        "joint": f"{RESULTS}/joint.svg",
        "joint_png": f"{RESULTS}/joint.png",
        "blow": f"{RESULTS}/blow.svg",
        "blow_png": f"{RESULTS}/blow.png",
    }
    if workflow.is_main_process:
        tables = [name for name in MEASURED if kind_of(name) == "stepped-sine"]
        try:
            if BEAM["set"] not in tables:
                refuse(
                    ("beam", "set"),
                    f"{BEAM['set']} is no set of kind stepped-sine; the configuration has "
                    f"{', '.join(tables) or 'none'}",
                    CONFIG_FILES,
                )
            if not Path(BEAM["record"]).is_file():
                refuse(
                    ("beam", "record"),
                    f"no file {BEAM['record']}: name one, {FROM}",
                    CONFIG_FILES,
                )
        except ConfigurationError as error:
            raise WorkflowError(str(error)) from None

    rule beam:
        input:
            records=record_files(BEAM["set"]),
            mappings=mapping_files(BEAM["set"]),
            blow=BEAM["record"],
            template=project_file("src/dampbalance/publishing/templates/beam.md.j2"),
            schema=MAPPING_SCHEMA,
            modules=script_modules("beam/beam.py"),
        output:
            **BEAM_FILES
            | {
                "page": report(
                    BEAM_FILES["page"],
                    caption="../report/beam.rst",
                    category="Reading",
                    labels={"result": "What the tables of a real joint say"},
                )
            },
        log:
            log_file("beam"),
        conda:
            ENVIRONMENT
        params:
            measured=MEASURED[BEAM["set"]],
            beam=BEAM,
        message:
            "What the tables of the beam say"
        script:
            "../scripts/beam/beam.py"
