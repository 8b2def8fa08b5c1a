/** Sends a file to the program; the name under which it can be opened. */
export function upload(file: File, progress: (share: number) => void): Promise<string> {
  return new Promise((resolve, reject) => {
    const request = new XMLHttpRequest();
    const query = new URLSearchParams(location.search);
    query.set("name", file.name);
    request.open("POST", `upload?${query}`);
    request.upload.addEventListener("progress", ({ loaded, total }) => progress(total ? loaded / total : 0));
    request.addEventListener("error", () => reject(new Error(`${file.name} could not be sent to the program`)));
    request.addEventListener("load", () => {
      if (request.status !== 200) return reject(new Error(request.responseText || `${file.name} was refused`));
      resolve(String((JSON.parse(request.responseText) as { upload: string }).upload));
    });
    request.send(file);
  });
}
