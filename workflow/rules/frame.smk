# What the records of a real rig say: make CONFIG=config/frame.yaml, where the records are (config/records/frame/README.md).
#
# The rule exists only where the configuration has the section `frame`, for nothing else knows which records it is about.

FRAME_FILES = {}

if config.get("frame"):
    FRAME = config["frame"]
    FRAME_FILES = {
        "page": f"{RESULTS}/frame.md",
        "numbers": f"{RESULTS}/frame.json",
        "loops": f"{RESULTS}/loops.svg",
        "loops_png": f"{RESULTS}/loops.png",
        "load": f"{RESULTS}/load.svg",
        "load_png": f"{RESULTS}/load.png",
    }
    if workflow.is_main_process:
        from dampbalance.replication.frame.findings import require

        try:
            if FRAME["set"] not in MEASURED:
                sets = ", ".join(MEASURED) or "none"
                refuse(
                    ("frame", "set"),
                    f"{FRAME['set']} is no set of records; the configuration has {sets}",
                    CONFIG_FILES,
                )
            try:
                require(MEASURED[FRAME["set"]], FRAME, len(record_files(FRAME["set"])))
            except ValueError as error:
                refuse(("frame",), str(error).removeprefix("frame: "), CONFIG_FILES)
        except ConfigurationError as error:
            raise WorkflowError(str(error)) from None

    rule frame:
        input:
            records=record_files(FRAME["set"]),
            mappings=mapping_files(FRAME["set"]),
            identification=f"{MEASURED_FILES}/{FRAME['set']}/identification.json",
            template=project_file("src/dampbalance/publishing/templates/frame.md.j2"),
            schema=MAPPING_SCHEMA,
            modules=script_modules("frame/frame.py"),
        output:
            **FRAME_FILES
            | {
                "page": report(
                    FRAME_FILES["page"],
                    caption="../report/frame.rst",
                    category="Reading",
                    labels={"result": "What the records of a real rig say"},
                )
            },
        log:
            log_file("frame"),
        conda:
            ENVIRONMENT
        params:
            measured=MEASURED[FRAME["set"]],
            frame=FRAME,
        message:
            "What the records of the frame say"
        script:
            "../scripts/frame/frame.py"
