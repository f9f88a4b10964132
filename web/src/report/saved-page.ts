// A report as one file: a web page that needs no server, with its pictures and styles in it.

function dataUrl(blob: Blob): Promise<string> {
  return new Promise((resolve, reject) => {
    const reader = new FileReader();
    reader.addEventListener("load", () => resolve(String(reader.result)));
    reader.addEventListener("error", () => reject(reader.error ?? new Error("the picture could not be read")));
    reader.readAsDataURL(blob);
  });
}

function escaped(text: string): string {
  return text.replace(/[&<>"]/g, (sign) => `&#${sign.charCodeAt(0)};`);
}

/** The page's source. `picture`: reads one from its address. */
export async function savedPage(
  report: HTMLElement,
  { title, language, css }: { title: string; language: string; css: string },
  picture: (url: string) => Promise<Blob>,
): Promise<Blob> {
  const copy = report.cloneNode(true) as HTMLElement;
  const read = new Map<string, Promise<string>>();
  for (const image of copy.querySelectorAll("img")) {
    const url = image.src;
    if (!read.has(url)) read.set(url, picture(url).then(dataUrl));
    image.src = (await read.get(url)) ?? url;
  }
  const html = `<!doctype html>
<html lang="${escaped(language)}">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>${escaped(title)}</title>
<style>${css}</style>
</head>
<body class="report saved">${copy.outerHTML}</body>
</html>
`;
  return new Blob([html], { type: "text/html" });
}
