# The guided tour: a plain script that is run as a notebook and shown as a page.

NOTEBOOK = "paper/notebook"


rule notebook:
    input:
        source=f"{NOTEBOOK}/tour.py",
        template=f"{NOTEBOOK}/page.html",
        style=f"{NOTEBOOK}/page.css",
        modules=script_modules("notebook/notebook.py"),
        imported=package_modules(f"{NOTEBOOK}/tour.py", ROOT / "src", relative_to=Path.cwd()),
    output:
        ipynb=f"{RESULTS}/notebook/tour.ipynb",
        html=report(
            f"{RESULTS}/notebook/tour.html",
            caption="../report/notebook.rst",
            category="Reading",
            labels={"result": "The guided tour"},
        ),
    message:
        "Notebook: the guided tour"
    script:
        "../scripts/notebook/notebook.py"
