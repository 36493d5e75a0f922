# The guided tour: a plain script that is run as a notebook.

NOTEBOOK = "paper/notebook"


rule notebook:
    input:
        source=project_file(f"{NOTEBOOK}/tour.py"),
        code=PACKAGE,
    output:
        ipynb=report(
            f"{RESULTS}/notebook/tour.ipynb",
            category="Reading",
            labels={"result": "The guided tour"},
        ),
    message:
        "Notebook: the guided tour"
    script:
        "../scripts/notebook/notebook.py"
