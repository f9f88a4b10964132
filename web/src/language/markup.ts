// Where index.html wants words: `data-text="group.name"` for an element's text, and so on for its attributes.

/** Words by group and name. */
type Groups = object;

/** What a name of words below `data-text-` is put into. */
const ATTRIBUTES: Readonly<Record<string, string>> = {
  label: "aria-label",
  title: "title",
  placeholder: "placeholder",
  content: "content",
  waiting: "data-waiting",
};

/** The words of a name such as `welcome.title`; null where they are none of these. */
function wordIn(words: Groups, name: string): string | null {
  const [group = "", key = ""] = name.split(".");
  const found = (words as Record<string, Record<string, unknown>>)[group]?.[key];
  return typeof found === "string" ? found : null;
}

function word(words: Groups, name: string): string {
  const found = wordIn(words, name);
  if (found === null) throw new Error(`the page wants words that there are not: ${name}`);
  return found;
}

/** Every second part is strong. */
function parts(text: string): string[] {
  return text.split("**");
}

function escaped(text: string): string {
  return text.replace(/[&<>"]/g, (sign) => `&#${sign.charCodeAt(0)};`);
}

/** The page's source with its words filled in. */
export function pageWithWords(html: string, words: Groups): string {
  return html.replace(
    /<(\w+)(\s[^<>]*\bdata-text[^<>]*)>(<\/\1>)?/g,
    (_, tag: string, attributes: string, end: string | undefined) => {
      const filled = attributes.replace(/data-text-(\w+)="([^"]*)"/g, (named, target: string, name: string) => {
        const attribute = ATTRIBUTES[target];
        if (attribute === undefined) throw new Error(`the page wants words for no attribute: ${named}`);
        return `${named} ${attribute}="${escaped(word(words, name))}"`;
      });
      const name = /\bdata-text="([^"]*)"/.exec(attributes)?.[1];
      if (name === undefined) return `<${tag}${filled}>${end ?? ""}`;
      if (end === undefined) throw new Error(`the page has words of its own beside ${name}`);
      const text = parts(word(words, name)).map((part, i) => (i % 2 === 1 ? `<b>${escaped(part)}</b>` : escaped(part)));
      return `<${tag}${filled}>${text.join("")}${end}`;
    },
  );
}

/** Puts another language's words in the place of those that the page came with; what is in none of these groups stays. */
export function applyWords(words: Groups): void {
  for (const element of document.querySelectorAll<HTMLElement>("[data-text]")) {
    const found = wordIn(words, element.dataset.text ?? "");
    if (found === null) continue;
    element.replaceChildren(
      ...parts(found).map((part, i) => (i % 2 === 1 ? Object.assign(document.createElement("b"), { textContent: part }) : part)),
    );
  }
  for (const [target, attribute] of Object.entries(ATTRIBUTES)) {
    for (const element of document.querySelectorAll(`[data-text-${target}]`)) {
      const found = wordIn(words, element.getAttribute(`data-text-${target}`) ?? "");
      if (found !== null) element.setAttribute(attribute, found);
    }
  }
}
